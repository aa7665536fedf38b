// A virtual print whose studio is killed in the middle of it, and the queue of jobs.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, program, setSpeed, startBrowser, startPrint, startStudio, takeTwin } from './studio.mjs';

const robot = new URL('../../examples/tutorial/finger.toml', import.meta.url).pathname;
const printer = new URL('../../examples/printers/tower.toml', import.meta.url).pathname;
let folder;
let browser;
let studio;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_resume_'));
  execFileSync(program, ['slice', robot, '--printer', printer, '--layer', '100 um', '-q', '-o', join(folder, 'finger.zip')]);
  studio = await startStudio(['finger.zip'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  rmSync(folder, { recursive: true, force: true });
});

const shown = (page, check, given) =>
  page.waitForFunction(check, given, { timeout: 120_000 }).catch(async () => assert.fail(await page.locator('main').innerText()));
const stateIs = (page, text) => shown(page, (s) => document.querySelector('[data-testid=print-state]')?.textContent === s, text);
const layer = (page) => page.getByTestId('print-layer').textContent().then(Number);

test('a virtual print is resumed after the studio was killed, and passes the inspection', async (t) => {
  const first = await openPage(browser, `${studio.address}#print`, t);
  await takeTwin(first.page, '60');
  await startPrint(first.page);
  await shown(first.page, () => Number(document.querySelector('[data-testid=print-layer]').textContent) >= 3);
  const broken = await layer(first.page);
  studio.child.kill('SIGKILL');
  // The page that was open does not claim to know what the machine does.
  await first.page.getByTestId('lost').waitFor();
  assert.equal(await first.page.getByTestId('print-state').textContent(), 'Unknown');
  assert.match(await first.page.title(), /^\? /);
  assert.ok(existsSync(join(folder, 'finger.zip.virtual.journal')));
  assert.ok(!existsSync(join(folder, 'finger.zip.journal')), 'a real machine hears nothing of it');
  const port = Number(new URL(studio.address).port);

  studio = await startStudio([], folder, port);
  // The same page comes back by itself, and says that there is no machine any more.
  await first.page.getByTestId('journals').waitFor({ timeout: 60_000 });
  const { page } = first;
  const line = page.getByTestId('journals').locator('button', { hasText: 'finger' });
  assert.match(await line.textContent(), /virtual printer.*interrupted/);
  await page.getByTestId('open-and-resume').click();
  await page.getByTestId('interrupted').waitFor();
  await setSpeed(page, 3000);
  assert.equal(await page.getByTestId('start').count(), 0, 'nothing is begun anew over a print that waits');
  // The part as far as it was printed is there again.
  await shown(page, (l) => Number(document.querySelector('[data-testid=part]')?.dataset.height) >= 0.1 * l - 1e-6, broken - 2);
  await page.getByTestId('go-on').click();
  await stateIs(page, 'Printed');
  await shown(page, () => document.querySelector('[data-testid=verdict]')?.dataset.passed === 'true');
  const journal = readFileSync(join(folder, 'finger.zip.virtual.journal'), 'utf8');
  assert.equal([...journal.matchAll(/ session /g)].length, 2);
  assert.match(journal, / end\b/);
  const lights = [...journal.matchAll(/ light step=\d+ layer=(\d+)/g)].map((m) => Number(m[1]));
  assert.equal(new Set(lights).size, await page.evaluate(() => window.pliant.job.value.manifest.layers.length));
});

test('jobs wait in a queue that is kept when the studio ends, and the next one starts with one click', async (t) => {
  const { page, wrong } = await openPage(browser, `${studio.address}#print`, t);
  // The machine of the print before may still be connected.
  await page.waitForSelector('[data-testid=leave], [data-testid=queue-add]');
  if (await page.getByTestId('leave').count()) await page.getByTestId('leave').click();
  await page.getByTestId('queue-add').click();
  await page.getByTestId('queued').first().waitFor();
  await page.getByTestId('queue-add').click();
  await shown(page, () => document.querySelectorAll('[data-testid=queued]').length === 2);
  assert.match(await page.getByTestId('queued').first().innerText(), /120 layers, \d+:\d\d:\d\d/);
  assert.deepEqual(JSON.parse(readFileSync(join(folder, 'print_queue.json'), 'utf8')).jobs, ['finger.zip', 'finger.zip']);
  await takeTwin(page, '3000');
  await startPrint(page);
  await stateIs(page, 'Printed');
  await page.getByTestId('next-in-queue').waitFor();
  await page.getByTestId('queue-next').click();
  // The machine of the print before is left first; its Start may stand there until then.
  await page.getByTestId('next-in-queue').waitFor({ state: 'detached' });
  await page.getByTestId('start').waitFor({ timeout: 60_000 });
  assert.deepEqual(JSON.parse(readFileSync(join(folder, 'print_queue.json'), 'utf8')).jobs, ['finger.zip'], 'what is printed waits no longer');
  await page.getByTestId('leave').click();
  // The print before is in the history with its own report.
  await shown(page, () => document.querySelectorAll('[data-testid=journals] li').length >= 2);
  const kept = page.getByTestId('journals').locator('button', { hasText: /20\d\d|\d{4}/ }).first();
  await kept.click();
  const report = page.waitForEvent('download');
  await page.getByTestId('journal').getByText('Report').click();
  assert.match(readFileSync(await (await report).path(), 'utf8'), /<html/);
  assert.deepEqual(wrong, []);
});
