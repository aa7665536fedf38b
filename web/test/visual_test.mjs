// States of the page look as they were approved: web/test/approved holds them, at half size. A picture may differ in a few
// pixels (fonts, rounding of the renderer), not in a thing that somebody would notice.
//   PLIANT_APPROVE=1 ... node web/test/run.mjs visual    draws them anew: look at each before it is committed.
import assert from 'node:assert/strict';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, redrawn, settled, startBrowser, startPrint, startStudio, takeTwin } from './studio.mjs';

const approved = new URL('approved/', import.meta.url).pathname;
const approve = Boolean(process.env.PLIANT_APPROVE);
const example = (name) => new URL(`../../examples/${name}`, import.meta.url).pathname;
const step = 40; // of 255: a change of a channel that counts
const most = 0.003; // share of pixels that may have changed
let folder;
let browser;
let studio;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_visual_'));
  copyFileSync(example('tutorial/finger.toml'), join(folder, 'finger.toml'));
  const text = readFileSync(join(folder, 'finger.toml'), 'utf8');
  mkdirSync(join(folder, 'simulated')); // coarse: it is the page that is looked at
  writeFileSync(join(folder, 'simulated', 'finger.toml'), text.replace('size = "4 mm"', 'size = "8 mm"').replace('steps = 20', 'steps = 4'));
  studio = await startStudio(['finger.toml'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  rmSync(folder, { recursive: true, force: true });
});

/// What changes from run to run, or from computer to computer: painted over.
const changing = ['.log', '.webcam', '[data-testid=notify]', '.notice', '[data-testid=print-layer] ~ *', '.small-figures', '.picture', '.with-button', '.under', '.u-wrap'];

/// At half size, as bytes of a PNG; `other`: another PNG of the same size, for the share of pixels that differ from it.
async function compared(page, shot, other) {
  return page.evaluate(
    async ([now, before, step]) => {
      const read = async (data) => {
        const image = new Image();
        image.src = `data:image/png;base64,${data}`;
        await image.decode();
        return image;
      };
      const canvas = (image, w, h) => {
        const c = Object.assign(document.createElement('canvas'), { width: w, height: h });
        const g = c.getContext('2d', { willReadFrequently: true });
        g.imageSmoothingQuality = 'high';
        g.drawImage(image, 0, 0, w, h);
        return c;
      };
      const image = await read(now);
      const [w, h] = [image.width >> 1, image.height >> 1];
      const half = canvas(image, w, h);
      const png = half.toDataURL('image/png').split(',')[1];
      if (!before) return { png, share: 1 };
      const old = await read(before);
      if (old.width !== w || old.height !== h) return { png, share: 1 };
      const [a, b] = [half, canvas(old, w, h)].map((c) => c.getContext('2d').getImageData(0, 0, w, h).data);
      let n = 0;
      for (let i = 0; i < a.length; i += 4) if (Math.max(Math.abs(a[i] - b[i]), Math.abs(a[i + 1] - b[i + 1]), Math.abs(a[i + 2] - b[i + 2])) > step) ++n;
      return { png, share: n / (w * h) };
    },
    [shot, other, step],
  );
}

/// The page as it is now, scrolled to its top.
async function shot(page) {
  await page.evaluate(() => {
    document.activeElement?.blur();
    for (const e of document.querySelectorAll('main, aside, .steer')) e.scrollTo({ top: 0, behavior: 'instant' });
    window.scrollTo({ top: 0, behavior: 'instant' });
    // Where form and picture stand one below the other, the picture is what is looked at.
    if (window.innerWidth <= 900) document.querySelector('.make .stage')?.scrollIntoView({ behavior: 'instant' });
  });
  await redrawn(page);
  const mask = changing.map((selector) => page.locator(selector));
  // A mask over the status would be as wide as its text, which changes.
  const style = '.status { opacity: 0 !important; }';
  return (await page.screenshot({ mask, maskColor: '#888888', style, animations: 'disabled' })).toString('base64');
}

/// Taken when the page has come to rest: two pictures one after the other are the same, or one is `asWanted`.
async function picture(page, asWanted = async () => false) {
  await page.waitForFunction(() => !/loading|Building/.test(document.querySelector('.layer-info')?.textContent ?? ''));
  let last = '';
  for (let k = 0; k < 20; ++k) {
    await page.waitForTimeout(300);
    const next = await shot(page);
    if (next === last || (await asWanted(next))) return next;
    last = next;
  }
  return last;
}

/// Compares the page as it stands with what was approved; gives what is wrong, or "".
async function look(page, name) {
  const file = join(approved, `${name}.png`);
  const known = existsSync(file) ? readFileSync(file).toString('base64') : '';
  let seen;
  await picture(page, async (next) => (seen = await compared(page, next, known)).share <= most);
  const { png, share } = seen;
  if (approve) {
    if (share > most) {
      mkdirSync(approved, { recursive: true });
      writeFileSync(file, Buffer.from(png, 'base64'));
    }
    return '';
  }
  if (share <= most) return '';
  const left = join(tmpdir(), `pliant_visual_${name}.png`);
  writeFileSync(left, Buffer.from(png, 'base64'));
  return known ? `${name}: ${(100 * share).toFixed(2)} % of the pixels differ from what was approved, see ${left}` : `${name} has not been approved: ${left}`;
}

const states = [
  ['light', 1440],
  ['dark', 1440],
  ['light', 390],
  ['dark', 390],
];

for (const [theme, width] of states) {
  test(`preparing and printing look like the approved pictures, ${theme}, ${width} px`, async (t) => {
    const { page } = await openPage(browser, studio.address, t, { colorScheme: theme, viewport: { width, height: 800 } });
    await settled(page);
    const wrong = [];
    const see = async (name) => wrong.push(await look(page, `${name}_${theme}_${width}`));
    await page.getByTestId('section-make').click();
    if (await page.getByTestId('make-bed').count()) await page.getByTestId('make-bed').click();
    await page.getByTestId('option-layer').fill('400');
    await page.waitForFunction(() => /30 layers/.test(document.querySelector('[data-testid=estimate]')?.textContent ?? ''));
    if (!(await page.getByTestId('make-bed').count())) await see('placement_first');
    else await see('placement');
    await page.getByTestId('slice').click();
    await page.getByTestId('cancel-slice').waitFor({ state: 'detached', timeout: 60_000 });
    await page.getByTestId('make-layers').click();
    await page.getByTestId('layer-view').waitFor();
    await see('layers');
    await page.getByTestId('make-stack').click();
    await page.waitForSelector('[data-testid=stack-view][data-state=shown]');
    await see('job');
    await page.getByTestId('make-plan').click();
    await page.getByTestId('gantt').waitFor();
    await see('plan');
    await page.getByTestId('section-print').click();
    await page.getByTestId('take-twin').waitFor();
    await see('no_machine');
    await takeTwin(page, '3000');
    await page.getByTestId('known').waitFor();
    await page.waitForFunction(() => !document.querySelector('.switches [data-state=unknown]') && document.querySelector('[data-testid=print-state]').textContent === 'Operational');
    await see('before_print');
    await startPrint(page);
    await page.getByTestId('verdict').waitFor({ timeout: 120_000 });
    await page.waitForFunction(() => document.querySelector('[data-testid=verdict-picture] img')?.complete);
    await see('printed');
    await page.getByTestId('leave').click();
    await page.getByTestId('take-twin').waitFor();
    assert.deepEqual(wrong.filter(Boolean), []);
  });
}

for (const [theme, width] of [['light', 1440], ['dark', 390]]) {
  test(`simulating and the wizards look like the approved pictures, ${theme}, ${width} px`, async (t) => {
    const own = await startStudio(['finger.toml'], join(folder, 'simulated'));
    t.after(() => own.stop());
    const { page } = await openPage(browser, own.address, t, { colorScheme: theme, viewport: { width, height: 800 } });
    await settled(page);
    const wrong = [];
    const see = async (name) => wrong.push(await look(page, `${name}_${theme}_${width}`));
    await page.getByRole('button', { name: 'Skip' }).click();
    await see('simulate');
    await page.getByTestId('field').selectOption({ label: 'Von Mises stress' });
    await page.getByTestId('fine').click();
    await page.waitForFunction(() => window.pliant.documentState.value.accuracy === 'fine');
    await page.waitForTimeout(500);
    await settled(page); // the curve's first state
    await page.getByTestId('number-flexor').fill('0.85');
    await page.keyboard.press('Enter');
    await page.waitForTimeout(500);
    await settled(page);
    await see('simulate_bent');
    for (const tab of ['build', 'goal', 'workspace', 'identify', 'sweep', 'plots', 'file']) {
      await page.getByTestId(`tab-${tab}`).click();
      await see(`simulate_${tab}`);
    }
    await page.getByTestId('tab-move').click();
    await page.getByTestId('open').click();
    await page.waitForFunction(() => {
      const thumbs = [...document.querySelectorAll('.open-list .thumb')];
      const hasExamples = thumbs.length > 1; // beside the finger of the folder
      return hasExamples && thumbs.every((thumb) => thumb.getBoundingClientRect().top > window.innerHeight || thumb.querySelector('img')?.complete);
    });
    await see('gallery');
    await page.keyboard.press('Escape');
    await page.getByTestId('section-print').click();
    for (const wizard of ['machine', 'projector', 'exposure', 'axes', 'first']) {
      await page.getByTestId(`wizard-${wizard}`).click();
      await page.getByTestId('wizard').waitFor();
      await see(`wizard_${wizard}`);
      await page.getByTestId('wizard-close').click();
    }
    assert.deepEqual(wrong.filter(Boolean), []);
  });
}

test('a visible change exceeds the tolerance: a missing button, a colour, a label', async (t) => {
  const { page } = await openPage(browser, `${studio.address}#make`, t, { colorScheme: 'light', viewport: { width: 1440, height: 800 } });
  await page.getByTestId('make-plan').click();
  await page.getByTestId('gantt').waitFor();
  const { png } = await compared(page, await picture(page), '');
  assert.ok((await compared(page, await picture(page), png)).share <= most, 'the same page again is the same picture');
  for (const [what, change] of [
    ['the button that slices', () => (document.querySelector('[data-testid=slice]').style.visibility = 'hidden')],
    ['the colour of the accent', () => document.documentElement.style.setProperty('--accent', '#8a2be2')],
    ['a larger font', () => (document.body.style.fontSize = '17px')],
  ]) {
    await page.evaluate(change);
    const { share } = await compared(page, await picture(page), png);
    assert.ok(share > most, `${what}: ${(100 * share).toFixed(3)} %`);
    await page.reload();
    await page.getByTestId('make-plan').click();
    await page.getByTestId('gantt').waitFor();
  }
});
