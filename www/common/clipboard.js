// @ts-check
/** The clipboard, where the browser lets a page write to it. */

/** Whether more than text can be put there. */
export const takesPictures = typeof ClipboardItem === 'function' && 'clipboard' in navigator;

/**
 * Puts one thing on the clipboard. What it is may still be on its way: some browsers forget that a button was pressed
 * while a page waits.
 *
 * @param {string} type `text/plain` or `image/png`
 * @param {Promise<Blob>} blob
 * @returns {Promise<boolean>} whether it is there now
 */
export async function copy(type, blob) {
  try {
    if (typeof ClipboardItem === 'function') await navigator.clipboard.write([new ClipboardItem({ [type]: blob })]);
    else await navigator.clipboard.writeText(await (await blob).text());
    return true;
  } catch (error) {
    // What could not be made is not the clipboard's fault.
    await blob;
    console.warn(error);
    return false;
  }
}

/** @param {string | Promise<string>} text */
export const copyText = (text) => copy('text/plain', Promise.resolve(text).then((words) => new Blob([words], { type: 'text/plain' })));
