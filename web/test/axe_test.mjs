// axe-core finds nothing: on every section and tab, light and dark, before and during a print. Every state is reached once
// and looked at in both themes.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { boxStl } from './shapes.mjs';
import { openPage, program, readRobot, redrawn, setSpeed, settled, startBrowser, startPrint, startStudio, takeTwin, typeRobot } from './studio.mjs';

const require = createRequire(join(process.env.PLIANT_WEB ?? new URL('..', import.meta.url).pathname, 'package.json'));
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const example = (name) => new URL(`../../examples/${name}`, import.meta.url).pathname;
let folder;
let browser;
let studio;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_axe_'));
  copyFileSync(example('tutorial/finger.toml'), join(folder, 'finger.toml'));
  execFileSync(program, ['slice', join(folder, 'finger.toml'), '--printer', example('printers/tower.toml'), '--layer', '1 mm', '-q', '-o', join(folder, 'finger.zip')]);
  studio = await startStudio(['finger.zip'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  rmSync(folder, { recursive: true, force: true });
});

/// Colours change at once: nothing that is looked at is on its way from one to another.
const wide = { viewport: { width: 1440, height: 900 }, reducedMotion: 'reduce' };

/// What axe finds, a line each: everything in the theme that is on, and in the other one what depends on colours.
async function found(page, where) {
  await page.evaluate((source) => window.axe ?? window.eval(source), axe);
  const wrong = [];
  const first = await page.evaluate(() => document.documentElement.dataset.theme);
  for (const theme of [first, first === 'dark' ? 'light' : 'dark']) {
    await page.emulateMedia({ colorScheme: theme });
    await page.waitForFunction((t) => document.documentElement.dataset.theme === t, theme);
    await redrawn(page);
    const options = { resultTypes: ['violations'], ...(theme === first ? {} : { runOnly: ['color-contrast', 'link-in-text-block'] }) };
    const violations = await page.evaluate(async (o) => (await window.axe.run(document, o)).violations, options);
    wrong.push(...violations.flatMap((v) => v.nodes.map((n) => `${where}, ${theme}: ${v.impact} ${v.id}: ${n.target.join(' ')}: ${n.failureSummary?.split('\n')[1]?.trim()}`)));
  }
  return wrong;
}

/// Every view that a person can come to, one after the other.
async function* views(page) {
  await page.getByTestId('section-simulate').click();
  for (const tab of ['move', 'build', 'goal', 'workspace', 'identify', 'sweep', 'plots', 'file']) {
    await page.getByTestId(`tab-${tab}`).click();
    yield `simulate, ${tab}`;
  }
  const good = await readRobot(page);
  await typeRobot(page, `${good}\nwrong = 1\n`);
  await page.getByTestId('apply').click();
  await page.getByTestId('problems').waitFor();
  yield 'simulate, an error in the file';
  await typeRobot(page, good);
  await page.getByTestId('apply').click();
  await page.getByTestId('problems').waitFor({ state: 'detached' });
  await page.getByTestId('tab-move').click();
  await page.getByTestId('pin').click();
  await page.getByRole('button', { name: 'Section' }).click();
  await page.getByTestId('field').selectOption('von_mises');
  await page.getByTestId('number-flexor').fill('-1');
  await page.getByTestId('number-flexor').press('Enter');
  await page.getByTestId('legend-button').click();
  await page.getByTestId('measure-toggle').click();
  yield 'simulate, a legend that is set, and measuring';
  await page.keyboard.press('Escape');
  await page.getByTestId('view-menu').click();
  yield 'simulate, the menu of sides';
  await page.keyboard.press('Escape');
  await page.getByTestId('tab-build').click();
  await page.getByTestId('place-chamber').click();
  yield 'simulate, placing a chamber';
  await page.getByTestId('place-chamber').click();
  await page.getByTestId('tab-move').click();
  yield 'simulate, pinned, in section, with stresses and a number out of range';
  await page.getByTestId('open').click();
  await page.locator('.open-list').waitFor();
  yield 'what can be opened';
  await page.keyboard.press('Escape');
  await page.getByTestId('section-make').click();
  for (const tab of await page.locator('.make [role=tab], .make .tabs button').all()) {
    await tab.click();
    yield `make, ${await tab.textContent()}`;
  }
  await page.evaluate(() => document.querySelectorAll('.make details').forEach((d) => (d.open = true)));
  yield 'make, all options';
  await page.getByTestId('section-print').click();
  yield 'print';
  for (const [width, height] of [[390, 844], [768, 1024]]) {
    await page.setViewportSize({ width, height });
    for (const section of ['simulate', 'make', 'print']) {
      await page.getByTestId(`section-${section}`).click();
      yield `${section}, ${width} pixels wide`;
    }
    await page.getByTestId('section-simulate').click();
    for (const tab of ['build', 'plots', 'file', 'move']) {
      await page.getByTestId(`tab-${tab}`).click();
      yield `simulate, ${tab}, ${width} pixels wide`;
    }
  }
  await page.getByTestId('section-print').click();
  await page.setViewportSize({ width: 1440, height: 900 });
}

test('axe finds no problem in any view', async (t) => {
  const { page } = await openPage(browser, studio.address, t, { colorScheme: 'dark', ...wide });
  await settled(page);
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
  const wrong = [];
  for await (const where of views(page)) wrong.push(...(await found(page, where)));
  await takeTwin(page, '60');
  wrong.push(...(await found(page, 'before a print')));
  await startPrint(page);
  await page.getByTestId('pause').waitFor();
  // As slow as a real one: looking at the page takes long on a small computer.
  await page.getByRole('button', { name: '1×', exact: true }).click();
  wrong.push(...(await found(page, 'a print')));
  await page.getByTestId('cancel').click();
  wrong.push(...(await found(page, 'whether to cancel')));
  await page.getByTestId('emergency').click();
  await page.getByTestId('stopped').waitFor({ timeout: 60_000 });
  wrong.push(...(await found(page, 'after an emergency stop')));
  await page.getByTestId('leave').click();
  await page.getByTestId('take-twin').waitFor();
  assert.deepEqual(wrong, []);
});

const widths = [390, 768, 1440];

/// What is built and understood on the page, one state after the other. It leaves the robot as it was.
async function understood(page, see) {
  const long = { timeout: 120_000 };
  await page.getByTestId('section-simulate').click();
  await page.getByTestId('open').click();
  await page.locator('.open-list .thumb img').first().waitFor();
  await see('the gallery');
  await page.keyboard.press('Escape');
  await page.getByTestId('tab-build').click();
  await page.getByTestId('place-chamber').click();
  for (const shape of ['box', 'cavity']) {
    await page.getByTestId(`chamber-${shape}`).click();
    await see(`a chamber as ${shape}`);
  }
  await page.getByTestId('place-chamber').click();
  const pick = (text) => page.getByTestId('build-geometry').setInputFiles({ name: 'axe.stl', mimeType: 'model/stl', buffer: Buffer.from(text) });
  await pick(boxStl([20, 10, 10]));
  await page.getByTestId('geometry-new').waitFor(long);
  await see('a file of geometry, its unit is asked for');
  await page.keyboard.press('Escape');
  await pick(boxStl([21, 10, 10]));
  await page.getByTestId('geometry-keep').waitFor(long);
  await see('a file that is there already');
  await page.keyboard.press('Escape');
  await pick('solid nothing');
  await page.getByTestId('geometry-refused').waitFor(long);
  await see('a file that is refused');
  await page.keyboard.press('Escape');
  await page.getByTestId('tab-sweep').click();
  await page.getByTestId('sweep-0-key').selectOption('cable.flexor.target.length_ratio');
  await page.getByTestId('sweep-second').click();
  await page.getByTestId('sweep-1-key').selectOption('?');
  await see('a sweep that is asked for, with a key that is typed');
  await page.getByTestId('sweep-1-typed').fill('program.steps');
  for (const which of [0, 1]) {
    await page.getByTestId(`sweep-${which}-count`).fill('2');
    await page.getByTestId(`sweep-${which}-count`).press('Enter');
  }
  await page.getByTestId('sweep-1-from').fill('2');
  await page.getByTestId('sweep-1-to').fill('3');
  await page.getByTestId('sweep-1-to').press('Enter');
  await page.getByTestId('find-sweep').click();
  await page.getByTestId('sweep-found').waitFor(long);
  await page.evaluate(() => document.querySelectorAll('.search details').forEach((d) => (d.open = true)));
  await page.getByTestId('sweep-run-1').click();
  await see('a sweep of two numbers, with its table');
  await page.getByTestId('tab-workspace').click();
  await page.getByTestId('workspace-side').fill('2');
  await page.getByTestId('workspace-side').press('Enter');
  await page.getByTestId('find-workspace').click();
  await page.getByTestId('workspace-found').waitFor(long);
  await see('a workspace');
  await page.getByTestId('motion-run').click();
  await page.getByTestId('motion-play').waitFor(long);
  await see('a motion that is played');
  await page.getByTestId('motion-leave').click();
  await page.getByTestId('tab-move').click();
  await page.getByTestId('compare').click();
  await page.locator('.compare-list .item').first().waitFor();
  await see('what can stand beside');
  await page.locator('.compare-list .item').first().click();
  await page.waitForSelector('[data-testid=beside][data-state=arrived]', long);
  await see('two robots');
  await page.getByTestId('compare-leave').click();
  await page.getByTestId('beside').waitFor({ state: 'detached' });
}

test('axe finds no problem in building and analysing robots, at any width', async (t) => {
  const { page } = await openPage(browser, studio.address, t, { colorScheme: 'light', ...wide });
  await settled(page);
  // Coarse and linear: it is the page that is looked at.
  await page.evaluate(() => window.pliant.post('/api/robot/set', { changes: [{ key: 'mesh.size', value: '8 mm' }, { key: 'program.steps', value: 2 }] }));
  await page.waitForFunction(() => window.pliant.scene.value?.head.program.steps === 2, undefined, { timeout: 60_000 });
  await settled(page);
  const wrong = [];
  await understood(page, async (where) => {
    for (const width of widths) {
      await page.setViewportSize({ width, height: 900 });
      wrong.push(...(await found(page, `${where}, ${width} px`)));
      const over = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      if (over > 0) wrong.push(`${where}, ${width} px: ${over} px wider than the window`);
    }
    await page.setViewportSize({ width: 1440, height: 900 });
  });
  assert.deepEqual(wrong, []);
});

/// Every state of preparing and printing, one after the other.
async function* steps(page) {
  await page.getByTestId('section-make').click();
  await page.getByTestId('make-bed').click();
  await page.getByTestId('estimate').waitFor();
  yield 'placement';
  await page.getByTestId('lay-on-face').click();
  await page.evaluate(() => document.querySelectorAll('.make details').forEach((d) => (d.open = true)));
  await page.getByTestId('option-copies').fill('24');
  await page.getByTestId('option-copies').blur();
  await page.waitForSelector('[data-testid=bed][data-fits=false]');
  yield 'placement, all options, too many copies, a face is to be picked';
  await page.getByTestId('slice').click();
  await page.locator('.make .problems').first().waitFor();
  yield 'an order that is refused';
  await page.getByTestId('option-copies').fill('1');
  await page.getByTestId('option-copies').blur();
  await page.evaluate(() => document.querySelectorAll('.make details').forEach((d) => (d.open = false)));
  await page.getByTestId('make-bed').click();
  await page.getByTestId('paint').click();
  yield 'painting supports';
  await page.getByTestId('brush-done').click();
  for (const tab of ['layers', 'stack', 'plan', 'compare']) {
    await page.getByTestId(`make-${tab}`).click();
    if (tab === 'stack') await page.waitForSelector('[data-testid=stack-view][data-state=shown]');
    yield `make, ${tab}`;
  }
  await page.getByTestId('section-print').click();
  yield 'print, no machine';
  await page.getByTestId('queue-add').click();
  await page.getByTestId('queued').waitFor();
  yield 'print, a job in the queue';
  await page.getByLabel(/^Remove .* from the queue/).click();
  for (const wizard of ['machine', 'projector', 'exposure', 'axes', 'first']) {
    await page.getByTestId(`wizard-${wizard}`).click();
    await page.getByTestId('wizard').waitFor();
    yield `wizard, ${wizard}`;
    await page.getByTestId('wizard-close').click();
  }
  await takeTwin(page, '60');
  yield 'before a print';
  await startPrint(page);
  await page.getByTestId('enlarge-light').waitFor({ timeout: 60_000 });
  await page.evaluate(() => document.querySelectorAll('.print details').forEach((d) => (d.open = true)));
  await setSpeed(page, 1); // slow enough to be looked at
  yield 'a print';
  await page.getByTestId('enlarge-light').click();
  yield 'the light enlarged';
  await page.keyboard.press('Escape');
  await setSpeed(page, 10); // a print pauses at the end of a layer
  await page.getByTestId('pause').click();
  await page.getByTestId('resume').waitFor({ timeout: 60_000 });
  yield 'paused';
  await setSpeed(page, 3000);
  await page.getByTestId('resume').click();
  await page.getByTestId('verdict').waitFor({ timeout: 120_000 });
  await page.locator('.notice').waitFor({ state: 'detached', timeout: 20_000 });
  yield 'printed, with its verdict';
  await page.getByTestId('leave').click();
  await page.getByTestId('take-twin').waitFor();
}

test('axe finds no problem in any state of preparing and printing, at any width', async (t) => {
  const { page } = await openPage(browser, studio.address, t, { colorScheme: 'light', ...wide });
  await settled(page);
  const wrong = [];
  for await (const where of steps(page)) {
    for (const width of widths) {
      await page.setViewportSize({ width, height: 900 });
      wrong.push(...(await found(page, `${where}, ${width} px`)));
      const over = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      if (over > 0) wrong.push(`${where}, ${width} px: ${over} px wider than the window`);
    }
  }
  assert.deepEqual(wrong, []);
});

test('the views of a job are tabs, and arrow keys switch between them', async (t) => {
  const { page } = await openPage(browser, `${studio.address}#make`, t);
  await page.getByTestId('make-layers').focus();
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.evaluate(() => document.activeElement.dataset.testid), 'make-stack');
  assert.equal(await page.getByTestId('make-stack').getAttribute('aria-selected'), 'true');
  await page.keyboard.press('End');
  assert.equal(await page.evaluate(() => document.activeElement.dataset.testid), 'make-compare');
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.evaluate(() => document.activeElement.dataset.testid), 'make-bed');
});
