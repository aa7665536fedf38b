// The mistakes of somebody who has never seen it: each ends in a sentence that says what is wrong and what would be right.
import assert from 'node:assert/strict';
import { copyFileSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, settled, startBrowser, startStudio } from './studio.mjs';

const example = (name) => new URL(`../../examples/${name}`, import.meta.url).pathname;
let folder;
let browser;
let studio;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_stranger_'));
  copyFileSync(example('tutorial/finger.toml'), join(folder, 'finger.toml'));
  copyFileSync(example('printers/single.toml'), join(folder, 'machine.toml'));
  writeFileSync(join(folder, 'broken.zip'), 'this is no archive');
  writeFileSync(join(folder, 'notes.toml'), 'hello = "world"\n');
  studio = await startStudio(['finger.toml'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  rmSync(folder, { recursive: true, force: true });
});

async function open(page, name) {
  await page.getByTestId('open').click();
  await page.locator('.open-list .item', { hasText: name }).click();
}
async function told(page, text) {
  await page
    .waitForFunction((t) => new RegExp(t).test(document.querySelector('[data-testid=notice]')?.textContent ?? ''), text.source)
    .catch(async () => assert.fail(`"${await page.getByTestId('notice').textContent({ timeout: 100 }).catch(() => '')}" is said, not ${text}`));
}

test('opening a printer file, a broken job or another text gives the right message, and the robot stays', async (t) => {
  const { page } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('open').click();
  await page.locator('.open-list .item').filter({ hasText: 'finger.toml' }).first().waitFor();
  assert.equal(await page.locator('.open-list .item').filter({ hasText: 'machine.toml' }).count(), 0);
  await page.keyboard.press('Escape');
  const refused = await page.evaluate(async () => {
    const headers = { 'Content-Type': 'application/json', 'X-Pliant-Page': sessionStorage.getItem('pliant_page') };
    return (await fetch('/api/open', { method: 'POST', headers, body: JSON.stringify({ name: 'machine.toml' }) })).json();
  });
  assert.match(refused.error, /machine\.toml is a printer file: choose it under Prepare/);
  await open(page, 'broken.zip');
  await told(page, /broken\.zip/);
  assert.match(await page.getByTestId('open').textContent(), /finger/);
  await open(page, 'notes.toml');
  await page.getByTestId('file-wrong').waitFor();
  await page.getByTestId('tab-file').click();
  assert.match(await page.getByTestId('problems').textContent(), /hello/);
  // The finger is not shown under another file's name.
  assert.equal(await page.getByTestId('open').textContent(), 'no robotnotes.toml');
  assert.equal(await page.evaluate(() => window.pliant.scene.value ?? window.pliant.frame.value), null);
  await page.getByTestId('tab-move').click();
  assert.match(await page.getByTestId('no-robot').textContent(), /could not be built/);
  assert.equal(await page.locator('input[type=range]').count(), 0);
  await open(page, 'finger.toml');
  await page.getByTestId('file-wrong').waitFor({ state: 'detached' });
  await settled(page);
});

test('without a job the page offers no print, and links to slicing', async (t) => {
  const { page, wrong } = await openPage(browser, `${studio.address}#print`, t);
  await page.getByText('There is no job yet').waitFor();
  assert.equal(await page.getByTestId('take-twin').count(), 0);
  await page.getByRole('link', { name: 'Slice the robot' }).click();
  await page.getByTestId('slice').waitFor();
  assert.deepEqual(wrong, []);
});

test('a missing port is named, and so is one that does not answer', async (t) => {
  const { page } = await openPage(browser, `${studio.address}#make`, t);
  await page.waitForFunction(() => window.pliant.scene.value !== null);
  await page.getByTestId('option-layer').fill('1000');
  await page.getByTestId('slice').click();
  await page.waitForSelector('[data-testid=layer-view]');
  await page.getByTestId('section-print').click();
  await page.getByTestId('save-job').click();
  await page.getByTestId('device').fill('/dev/ttyNOBODY7');
  await page.getByTestId('projector').fill('light');
  await page.getByTestId('take-port').click();
  await told(page, /there is no \/dev\/ttyNOBODY7/);
  await page.getByTestId('device').fill('/dev/null');
  await page.getByTestId('take-port').click();
  await page.waitForSelector('[data-testid=print-state]');
  await page.waitForFunction(() => document.querySelector('[data-testid=print-state]').textContent === 'Error');
  assert.match(await page.locator('.steer').innerText(), /\/dev\/null/);
  assert.match(await page.getByTestId('known').textContent(), /the machine does not respond/);
  assert.ok(await page.getByTestId('start').isDisabled());
  await page.getByTestId('leave').click();
  await page.getByTestId('take-port').waitFor();
});

test('a studio that has ended is reported as such, also during a print', async (t) => {
  const other = await startStudio(['finger.zip'], folder);
  const { page } = await openPage(browser, `${other.address}#print`, t);
  await page.getByTestId('take-speed').selectOption('60');
  await page.getByTestId('take-twin').click();
  await page.waitForSelector('[data-testid=print-state]');
  for (const box of await page.locator('.checklist input').all()) await box.check();
  await page.getByTestId('start').click();
  await page.waitForFunction(() => document.querySelector('[data-testid=print-state]').textContent === 'Printing');
  assert.equal(await page.getByTestId('lost').count(), 0);
  other.child.kill('SIGKILL');
  await page.getByTestId('lost').waitFor();
  assert.match(await page.getByTestId('lost').textContent(), /lost its connection to the studio.*use its own switch/);
  await page.getByTestId('emergency').click();
  await told(page, /The studio does not respond/);
});

test('after the studio has ended the robot is shown as last known, and the menu says why it cannot open', async (t) => {
  const other = await startStudio([], folder);
  const { page, wrong } = await openPage(browser, other.address, t);
  await settled(page);
  other.child.kill('SIGKILL');
  await page.getByTestId('lost').waitFor();
  await page.waitForSelector('[data-testid=status][data-state=unknown][data-lamp=unknown]');
  assert.match(await page.getByTestId('status').textContent(), /last known state/);
  assert.equal(await page.getByTestId('replay-at').textContent(), 'last');
  await page.getByTestId('open').click();
  await told(page, /The studio does not respond/);
  assert.deepEqual(wrong.filter((w) => !/ERR_CONNECTION|WebSocket/.test(w)), []);
});

test('the page holds the licences of its libraries', async (t) => {
  const { page } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('open').click();
  const address = await page.getByTestId('notices').evaluate((link) => link.href);
  const answer = await page.request.get(address);
  assert.equal(answer.status(), 200);
  const text = await answer.text();
  for (const name of ['preact', '@preact/signals', '@preact/signals-core', 'three', 'uplot']) {
    assert.match(text, new RegExp(`^${name} [0-9.]+ \\(MIT\\)$`, 'm'));
  }
  assert.ok(text.match(/Permission is hereby granted/g).length >= 5);
});
