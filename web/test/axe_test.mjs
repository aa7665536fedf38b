// axe-core finds nothing: on every section and tab, light and dark, before and during a print.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, program, settled, startBrowser, startPrint, startStudio, takeTwin } from './studio.mjs';

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

/// What axe finds, a line each.
async function found(page, where) {
  await page.waitForTimeout(300); // colours change over 120 ms
  await page.evaluate((source) => window.axe ?? window.eval(source), axe);
  const violations = await page.evaluate(async () => (await window.axe.run(document, { resultTypes: ['violations'] })).violations);
  return violations.flatMap((v) => v.nodes.map((n) => `${where}: ${v.impact} ${v.id}: ${n.target.join(' ')}: ${n.failureSummary?.split('\n')[1]?.trim()}`));
}

/// Every view that a person can come to, one after the other.
async function* views(page) {
  await page.getByTestId('section-simulate').click();
  for (const tab of ['move', 'plots', 'file']) {
    await page.getByTestId(`tab-${tab}`).click();
    yield `simulate, ${tab}`;
  }
  const file = page.getByTestId('robot-file');
  const good = await file.inputValue();
  await file.fill(`${good}\nwrong = 1\n`);
  await page.getByTestId('apply').click();
  await page.getByTestId('problems').waitFor();
  yield 'simulate, an error in the file';
  await file.fill(good);
  await page.getByTestId('apply').click();
  await page.getByTestId('problems').waitFor({ state: 'detached' });
  await page.getByTestId('tab-move').click();
  await page.getByTestId('pin').click();
  await page.getByRole('button', { name: 'Section' }).click();
  await page.getByTestId('field').selectOption('von_mises');
  await page.getByTestId('number-flexor').fill('-1');
  await page.getByTestId('number-flexor').press('Enter');
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
  await page.setViewportSize({ width: 390, height: 844 });
  for (const section of ['simulate', 'make', 'print']) {
    await page.getByTestId(`section-${section}`).click();
    yield `${section} on a phone`;
  }
  await page.setViewportSize({ width: 1440, height: 900 });
}

for (const theme of ['light', 'dark']) {
  test(`axe finds nothing, ${theme}`, async (t) => {
    const { page } = await openPage(browser, studio.address, t, { colorScheme: theme, viewport: { width: 1440, height: 900 } });
    await settled(page);
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), theme);
    const wrong = [];
    for await (const where of views(page)) wrong.push(...(await found(page, where)));
    await takeTwin(page, '60');
    wrong.push(...(await found(page, 'before a print')));
    await startPrint(page);
    await page.getByTestId('pause').waitFor();
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
}
