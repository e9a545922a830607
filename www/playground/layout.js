// @ts-check
/** What of the page's layout is remembered or moves: the drawer, the fold of the advanced settings, ways to the cards. */
import { embedOptions } from './embed.js';
import { recall, remember } from '../common/memory.js';

/** Parts that fold, and their names in the browser's storage. The statistics remember themselves. */
const FOLDS = { loss: 'pointweave.loss', 'advanced-fold': 'pointweave.advanced' };

const { embed: framed } = embedOptions(location);
for (const [id, key] of Object.entries(FOLDS)) {
  const fold = /** @type {HTMLDetailsElement} */ (document.getElementById(id));
  // Who puts the loss into a frame wants to see it.
  fold.open = framed ? id === 'loss' : recall(key) === 'open';
  fold.addEventListener('toggle', () => {
    if (!framed) remember(key, fold.open ? 'open' : 'closed');
  });
}

for (const button of /** @type {NodeListOf<HTMLButtonElement>} */ (document.querySelectorAll('[data-jump]'))) {
  button.addEventListener('click', () => {
    const card = /** @type {HTMLElement} */ (document.getElementById(button.dataset.jump ?? ''));
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    card.scrollIntoView({ block: 'start', behavior: calm ? 'auto' : 'smooth' });
    card.focus({ preventScroll: true });
    card.toggleAttribute('data-shown', false);
    // Says where it is, also where everything was in sight already.
    requestAnimationFrame(() => card.toggleAttribute('data-shown', true));
  });
}
