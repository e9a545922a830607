// @ts-check
/** Notices: the one place where the page says what went wrong or waits for a person, and the one for those who can't see. */
import { element } from '../common/elements.js';

/** @typedef {{ label: string, act: () => void }} Offer a button of a notice */

export class Notices {
  #place = element('notices');
  #live = element('live');

  /**
   * Says something; the next notice replaces it.
   *
   * @param {string} text
   * @param {Offer} [offer]
   */
  notify(text, offer) {
    const notice = document.createElement('div');
    notice.className = 'notice';
    const words = document.createElement('p');
    words.textContent = text;
    notice.append(words);
    if (offer) {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = offer.label;
      button.onclick = () => {
        this.unnotify();
        offer.act();
      };
      notice.append(button);
    }
    const close = document.createElement('button');
    close.type = 'button';
    close.className = 'close';
    close.textContent = '×';
    close.setAttribute('aria-label', 'Dismiss');
    close.onclick = () => this.unnotify();
    notice.append(close);
    this.#place.replaceChildren(notice);
  }

  unnotify() {
    this.#place.replaceChildren();
  }

  /**
   * @param {string} message a sentence of the library; those begin small and have no full stop
   * @param {Offer} [offer]
   */
  complain(message, offer) {
    this.complainAbout('', message.charAt(0).toUpperCase() + message.slice(1), offer);
  }

  /**
   * @param {string} start what must stay as it is, such as a file's name
   * @param {string} message
   * @param {Offer} [offer]
   */
  complainAbout(start, message, offer) {
    this.notify(start + message + (/[.!?]$/.test(message) ? '' : '.'), offer);
  }

  /** @param {string} text for those who do not see the canvas move */
  announce(text) {
    this.#live.textContent = text;
  }
}
