// @ts-check
/**
 * Dark or light: as the system has it, or as the person chose. Runs before anything is painted, so that no page flashes
 * white at night; so it is not a module. It turns the style sheets' own dark rules on and off and tells the window
 * `themechange`, also when the system changes.
 */
{
  const KEY = 'pointweave.theme';
  const QUERY = '(prefers-color-scheme: dark)';
  const CHOICES = ['auto', 'light', 'dark'];
  /** @type {string} */
  let choice = 'auto';
  try {
    choice = CHOICES.find((name) => name === localStorage.getItem(KEY)) ?? 'auto';
  } catch {
    // Then the system's.
  }

  /** The dark rules of every style sheet, found while they still say so. @type {CSSMediaRule[]} */
  const rules = [...document.styleSheets]
    .flatMap((sheet) => [...sheet.cssRules])
    .filter((rule) => rule instanceof CSSMediaRule && rule.conditionText === QUERY)
    .map((rule) => /** @type {CSSMediaRule} */ (rule));
  const bars = /** @type {NodeListOf<HTMLMetaElement>} */ (document.querySelectorAll('meta[name="theme-color"]'));
  const barMedia = [...bars].map((bar) => bar.media);

  function apply() {
    const on = { auto: QUERY, light: 'not all', dark: 'all' }[choice] ?? QUERY;
    for (const rule of rules) rule.media.mediaText = on;
    document.documentElement.style.colorScheme = choice === 'auto' ? '' : choice;
    for (const [index, bar] of bars.entries()) {
      const wanted = barMedia[index].includes('dark') ? 'dark' : 'light';
      bar.media = choice === 'auto' ? barMedia[index] : choice === wanted ? 'all' : 'not all';
    }
    window.dispatchEvent(new Event('themechange'));
  }

  if (choice !== 'auto') apply();
  matchMedia(QUERY).addEventListener('change', () => void (choice === 'auto' && window.dispatchEvent(new Event('themechange'))));

  document.addEventListener('DOMContentLoaded', () => {
    for (const input of /** @type {NodeListOf<HTMLInputElement>} */ (document.querySelectorAll('input[name="theme"]'))) {
      input.checked = input.value === choice;
      input.addEventListener('change', () => {
        choice = input.value;
        try {
          localStorage.setItem(KEY, choice);
        } catch {
          // Then it holds for this visit.
        }
        apply();
      });
    }
  });
}
