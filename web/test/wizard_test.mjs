// The wizards: each writes the printer file, nothing moves or lights unasked, the emergency stop stays.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, realpathSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, program, setSpeed, startBrowser, startStudio } from './studio.mjs';

const printer = new URL('../../examples/printers/tower.toml', import.meta.url).pathname;
let folder;
let browser;
let studio;
let twin;

const pause = (ms) => new Promise((done) => setTimeout(done, ms));
const file = () => readFileSync(join(folder, 'mine.toml'), 'utf8');

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_wizard_'));
  twin = spawn(program, ['twin', '--printer', printer, '--pty', join(folder, 'printer'), '-q'], { stdio: 'ignore' });
  for (let k = 0; k < 100 && !existsSync(join(folder, 'printer')); ++k) await pause(100);
  studio = await startStudio([], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  twin?.kill('SIGTERM');
  rmSync(folder, { recursive: true, force: true });
});

const at = (page, step) => page.waitForSelector(`[data-testid=wizard][data-step="${step}"]`, { timeout: 120_000 });
async function next(page, step) {
  await page.getByTestId('wizard-next').click();
  await at(page, step).catch(async () => assert.fail(await page.getByTestId('wizard').innerText()));
}
async function open(t, name) {
  const opened = await openPage(browser, `${studio.address}#print`, t);
  await opened.page.getByTestId(`wizard-${name}`).click();
  await at(opened.page, 0);
  return opened;
}

test('setting up a machine from the list, over its port, with axes and vats keeps the file\'s comments', async (t) => {
  const { page, wrong } = await open(t, 'machine');
  await page.getByTestId('from-tower').check();
  await page.getByTestId('printer-file-name').fill('mine.toml');
  await page.getByTestId('printer-title').fill('our tower');
  await next(page, 1);
  await page.getByTestId('wizard-device').fill(realpathSync(join(folder, 'printer')));
  await page.getByTestId('ask-board').click();
  await page.getByTestId('board').waitFor({ timeout: 60_000 }).catch(async () => assert.fail(await page.getByTestId('wizard').innerText()));
  assert.match(await page.getByTestId('board').innerText(), /Pliant twin.*responds/);
  await page.getByTestId('baud').fill('250000');
  await next(page, 2);
  await page.getByTestId('axis-carriage-max').fill('360');
  await page.getByTestId('axis-tower-speed').fill('35');
  await next(page, 3);
  await page.getByTestId('wizard-back').click();
  await at(page, 2);
  assert.equal(await page.getByTestId('axis-carriage-max').inputValue(), '360');
  await next(page, 3);
  await next(page, 4);
  const text = file();
  assert.match(text, /name = "our tower"/);
  assert.match(text, /baud_rate = 250000/);
  assert.match(text, /travel = \["0 mm", "360 mm"\]/);
  assert.match(text, /# rack and pinion, 99:1/, 'comments stay');
  assert.match(text, /# The prototype of the thesis/);
  await page.getByTestId('wizard-next').click();
  await page.getByTestId('section-make').click();
  await page.waitForFunction(() => document.querySelector('[data-testid=printer]').value === 'mine.toml');
  assert.deepEqual(wrong, []);
});

test('an invalid value is refused at its step, and nothing is written', async (t) => {
  const { page } = await open(t, 'machine');
  await page.getByTestId('from-mine.toml').check();
  await next(page, 1);
  await next(page, 2);
  const before = file();
  await page.getByTestId('axis-carriage-max').fill('3');
  await page.getByTestId('wizard-next').click();
  await page.getByTestId('wizard-why').waitFor();
  assert.match(await page.getByTestId('wizard-why').innerText(), /mine\.toml/);
  assert.equal(file(), before);
});

test('projector focus and size: a pattern is shown only on request, and the measured size is written', async (t) => {
  const { page, wrong } = await open(t, 'projector');
  await page.getByTestId('wizard-file').selectOption('mine.toml');
  await page.getByTestId('wizard-projector').fill('light');
  await next(page, 1);
  const lit = () => existsSync(join(folder, 'light', 'shown.png'));
  assert.ok(!lit(), 'nothing is lit unasked');
  await page.getByTestId('pattern-square').fill('wide');
  await page.getByTestId('pattern-wrong').waitFor();
  assert.ok(await page.getByTestId('pattern-show').isDisabled());
  await page.getByTestId('pattern-square').fill('8');
  await page.getByTestId('pattern-show').click();
  await page.waitForFunction(() => / is on/.test(document.querySelector('[data-testid=pattern-state]').textContent));
  for (let k = 0; k < 100 && !lit(); ++k) await pause(100);
  assert.ok(lit());
  await page.getByTestId('pattern-dark').click();
  for (let k = 0; k < 100 && lit(); ++k) await pause(100);
  assert.ok(!lit(), 'dark when asked for');
  await next(page, 2);
  const span = await page.evaluate(async () => (await fetch('/api/printer/measured', { method: 'POST', body: JSON.stringify({ name: 'mine.toml' }) })).json());
  await page.getByTestId('measured-x').fill('broad');
  assert.ok(await page.getByTestId('wizard-next').isDisabled(), 'a word is no width');
  await page.getByTestId('measured-x').fill((span.x_px * 0.05).toFixed(3));
  await page.getByTestId('measured-y').fill((span.y_px * 0.05).toFixed(3));
  await page.getByTestId('pixel-found').waitFor();
  assert.ok(Math.abs(Number(await page.getByTestId('pixel-found').getAttribute('data-um')) - 50) < 0.05);
  await next(page, 3);
  assert.match(file(), /pixel = "(50|49\.99\d|50\.00\d)(\.\d+)? um"/);
  assert.deepEqual(wrong, []);
});

test('exposure finder: one job has a ramp of exposures, and the chosen one is written', async (t) => {
  const { page, wrong } = await open(t, 'exposure');
  await page.getByTestId('wizard-file').selectOption('mine.toml');
  await page.getByTestId('finder-resin').selectOption('semi-flex');
  await page.getByTestId('finder-from').fill('1');
  await page.getByTestId('finder-to').fill('4');
  await page.getByTestId('finder-count').fill('4');
  assert.match(await page.getByTestId('pieces').innerText(), /1 s\s+2 s\s+3 s\s+4 s/);
  await next(page, 1);
  const exposures = await page.evaluate(() => window.pliant.job.value.manifest.materials.map((m) => m.exposure_s));
  assert.deepEqual([...exposures].sort(), [1, 2, 3, 4]);
  assert.equal(await page.evaluate(() => new Set(window.pliant.job.value.manifest.materials.map((m) => m.resin)).size), 1);
  assert.equal(await page.evaluate(() => window.pliant.job.value.plan.swaps), 0, 'all from one vat');
  // To the print and back.
  await page.getByTestId('finder-print').click();
  await page.getByTestId('take-twin').waitFor();
  await page.getByTestId('guide-back').click();
  await at(page, 1);
  await next(page, 2);
  assert.ok(await page.getByTestId('wizard-next').isDisabled(), 'nothing is picked yet');
  await page.getByTestId('piece-3').check();
  await next(page, 3);
  assert.match(await page.getByTestId('finder-kept').innerText(), /semi-flex now has 3 s/);
  assert.match(file(), /exposure = "3 s"/);
  assert.deepEqual(wrong, []);
});

test('axes on the virtual printer: home, jog and swap; the emergency stop stays in place', async (t) => {
  const { page, wrong } = await open(t, 'axes');
  await page.getByTestId('wizard-file').selectOption('mine.toml');
  await page.getByTestId('axes-twin').click();
  await page.getByTestId('axes-connected').waitFor({ timeout: 120_000 });
  await setSpeed(page, 3000);
  assert.ok(await page.getByTestId('emergency').isVisible());
  await next(page, 1);
  assert.ok(await page.getByTestId('wizard-next').isDisabled(), 'nothing has moved, nothing is homed');
  await page.getByTestId('axes-home').click();
  await page.waitForFunction(() => !document.querySelector('[data-testid=wizard-next]').disabled, undefined, { timeout: 60_000 });
  await next(page, 2);
  assert.ok(await page.getByTestId('emergency').isVisible());
  await page.getByLabel('Move platform by −5').click();
  await page.waitForFunction(() => /Operational/.test(document.querySelector('[data-testid=axes-state]').textContent), undefined, { timeout: 60_000 });
  await next(page, 3);
  for (const [button, slot] of [['fetch-1', /slot 1/], ['fetch-2', /slot 2/], ['fetch-0', /No vat/]]) {
    await page.waitForFunction((b) => !document.querySelector(`[data-testid=${b}]`).disabled, button, { timeout: 60_000 });
    await page.getByTestId(button).click();
    await page.waitForFunction((s) => new RegExp(s).test(document.querySelector('[data-testid=axes-slot]').textContent), slot.source, { timeout: 90_000 });
  }
  assert.ok(await page.getByTestId('emergency').isVisible());
  await page.waitForFunction(() => /Operational/.test(document.querySelector('[data-testid=axes-state]').textContent), undefined, { timeout: 60_000 });
  await next(page, 4);
  assert.match(await page.getByTestId('wizard').innerText(), /Axes and swap of mine.toml have been tested/);
  await page.getByTestId('axes-leave').click();
  assert.deepEqual(wrong, []);
});

test('what is typed as a port is not mixed with a port that is found meanwhile', async (t) => {
  const { page } = await openPage(browser, `${studio.address}#print`, t);
  let found;
  const begun = new Promise((done) => (found = done));
  await page.route('**/api/print/ports', async (route) => {
    await begun;
    await route.fulfill({ json: { ports: [{ device: '/dev/ttyACM7', name: 'a board' }], displays: [], without: '' } });
  });
  await page.getByTestId('wizard-machine').click();
  await at(page, 0);
  await page.getByTestId('from-tower').check();
  await page.getByTestId('printer-file-name').fill('typed.toml');
  await next(page, 1);
  await page.getByTestId('wizard-device').focus();
  found();
  await page.getByText('/dev/ttyACM7 a board').waitFor();
  await page.keyboard.type('/dev/ttyUSB0');
  assert.equal(await page.getByTestId('wizard-device').inputValue(), '/dev/ttyUSB0');
  await page.getByTestId('wizard-close').click();
});
