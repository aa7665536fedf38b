// The page without a mouse: where the focus is after each step of the way from a robot to a print, and how the text of the
// robot file is left, undone and saved.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, readRobot, settled, startBrowser, startStudio, typeRobot } from './studio.mjs';
import { block } from './shapes.mjs';

let folder;
let studio;
let browser;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_keyboard_'));
  writeFileSync(join(folder, 'block.toml'), block('1 MPa'));
  writeFileSync(join(folder, 'other.toml'), block('7 MPa').replace('"block"', '"other"'));
  writeFileSync(join(folder, 'bad.toml'), 'name = "bad"\n[material.x\n');
  studio = await startStudio(['block.toml'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  assert.equal(await studio?.stop(), 0);
  rmSync(folder, { recursive: true, force: true });
});

/// What has the focus is named so.
const focused = (page, testId) => page.waitForFunction((id) => document.activeElement?.dataset.testid === id, testId);

/// Presses a button as the keyboard does.
async function press(page, target, key = 'Enter') {
  await target.focus();
  await target.press(key);
}
const item = (page, name) => page.locator('.open-list .item', { hasText: name });

async function edited(t) {
  const own = await startStudio(['block.toml'], folder);
  t.after(() => own.stop());
  const opened = await openPage(browser, own.address, t);
  await settled(opened.page);
  await opened.page.getByTestId('tab-file').click();
  await opened.page.waitForFunction(() => window.pliant.robotText.value.includes('youngs_modulus'));
  return opened;
}
const holds = (page, text) => page.waitForFunction((t) => window.pliant.robotText.value === t, text);

test('Ctrl+Z in the text takes back each change of the robot, wherever it was made, and never puts in the text of another one', async (t) => {
  const { page, wrong } = await edited(t);
  const editor = page.getByTestId('robot-file');
  const first = await readRobot(page);
  const second = first.replace('size = "6 mm"', 'size = "7 mm"');
  await typeRobot(page, second);
  await editor.press('Control+Enter');
  const modulus = page.getByTestId('modulus-soft');
  await modulus.fill('3');
  await modulus.press('Enter');
  const third = second.replace('"1 MPa"', '"3 MPa"');
  await holds(page, third);
  for (const text of [second, first]) {
    await editor.press('Control+z');
    await holds(page, text);
  }
  for (const text of [second, third]) {
    await editor.press('Control+y');
    await holds(page, text);
  }
  await typeRobot(page, `${third}# typed\n`);
  await page.getByTestId('open').click();
  await item(page, 'other.toml').click();
  await page.getByTestId('discard').click();
  await page.waitForFunction(() => window.pliant.robotText.value.includes('name = "other"'));
  const other = await readRobot(page);
  await editor.press('Control+z');
  await editor.press('End'); // by now the text would have changed
  assert.equal(await readRobot(page), other);
  assert.ok(await page.getByTestId('apply').isDisabled());
  assert.deepEqual(wrong.filter((w) => !/thumbnail/.test(w)), []);
});

test('the text says how the keyboard leaves it; Ctrl+S applies and saves it, or asks for a name', async (t) => {
  const { page, wrong } = await edited(t);
  const editor = page.getByTestId('robot-file');
  const first = await readRobot(page);
  const described = await editor.getAttribute('aria-describedby');
  assert.match(await page.locator(`#${described}`).textContent(), /Esc, then Tab, leaves the text/);
  await editor.press('Control+End');
  await editor.press('Tab');
  await holds(page, `${first}  `);
  await focused(page, 'robot-file');
  await editor.press('Escape');
  await page.keyboard.press('Tab');
  await page.waitForFunction(() => !document.querySelector('.editor .code').contains(document.activeElement));
  const second = first.replace('size = "6 mm"', 'size = "7 mm"');
  await typeRobot(page, second);
  await editor.press('Control+s');
  await page.waitForFunction(() => window.pliant.documentState.value.undo === 1 && !window.pliant.documentState.value.unsaved);
  assert.equal(readFileSync(join(folder, 'block.toml'), 'utf8'), second);
  writeFileSync(join(folder, 'block.toml'), first);
  // A robot without a file.
  await page.evaluate((text) => fetch('/api/robot/new', { method: 'POST', headers: { 'Content-Type': 'text/plain', 'X-Pliant-Page': window.pliant.page }, body: text }), second);
  await page.waitForFunction(() => window.pliant.documentState.value.name === '' && document.querySelector('[data-testid=apply]').disabled);
  await editor.press('Control+s');
  await focused(page, 'save-name');
  await page.keyboard.press('Escape');
  await focused(page, 'robot-file');
  assert.deepEqual(wrong, []);
});

test('a menu gives the focus back once something was chosen, also after a question, and closes where Tab leaves it', async (t) => {
  const { page } = await edited(t);
  const menu = page.getByTestId('open');
  await press(page, menu);
  await press(page, item(page, 'other.toml'));
  await focused(page, 'open');
  await page.waitForFunction(() => window.pliant.robotText.value.includes('name = "other"'));
  await typeRobot(page, `${await readRobot(page)}# typed\n`);
  for (const answer of ['keep-editing', 'discard']) {
    await press(page, menu);
    await press(page, item(page, 'block.toml'));
    await press(page, page.getByTestId(answer));
    await focused(page, 'open');
  }
  await page.waitForFunction(() => window.pliant.robotText.value.includes('name = "block"'));
  await press(page, menu);
  await item(page, 'other.toml').waitFor();
  await page.keyboard.press('Shift+Tab');
  await item(page, 'other.toml').waitFor({ state: 'detached' });
  assert.equal(await menu.getAttribute('aria-expanded'), 'false');
});

const landed = (page) => page.waitForFunction(() => document.activeElement?.classList.contains('landing'));

test('through a print, the focus stays at the button that takes the place of the one that was pressed', async (t) => {
  const own = await startStudio(['block.toml'], folder);
  t.after(() => own.stop());
  const { page } = await openPage(browser, `${own.address}#print`, t);
  await page.waitForFunction(() => window.pliant.helm.value.you && window.pliant.scene.value);
  await page.evaluate(() => window.pliant.post('/api/job/slice', { printer: 'tower', layer: '0.5 mm', 'any-vat': true }));
  await press(page, page.getByTestId('save-job'));
  await focused(page, 'device');
  await page.getByTestId('take-speed').selectOption('10');
  await press(page, page.getByTestId('take-twin'));
  await page.getByTestId('start').waitFor();
  await landed(page);
  for (const box of await page.locator('.checklist input').all()) await box.press('Space');
  await press(page, page.getByTestId('start'));
  for (const next of ['pause', 'resume', 'pause']) {
    await focused(page, next);
    if (next === 'resume') await page.waitForFunction(() => document.activeElement.getAttribute('aria-disabled') === 'false');
    await page.keyboard.press('Enter');
  }
  await focused(page, 'resume');
  await page.keyboard.press('Tab');
  await focused(page, 'cancel');
  for (const [key, next] of [['Enter', 'keep-printing'], ['Escape', 'cancel'], ['Enter', 'keep-printing'], ['Enter', 'cancel'], ['Enter', 'keep-printing']]) {
    await page.keyboard.press(key);
    await focused(page, next);
  }
  await page.keyboard.press('Tab');
  await focused(page, 'cancel-sure');
  await page.keyboard.press('Enter');
  await focused(page, 'cancel');
  await page.getByTestId('start').waitFor();
  await landed(page);
});
