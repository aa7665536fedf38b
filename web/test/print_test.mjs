// A print on a machine at a port, from the page: the machine is `pliant twin` on a pseudo-terminal.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, realpathSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, program, says, startBrowser, startStudio } from './studio.mjs';

const robot = new URL('../../examples/tutorial/finger.toml', import.meta.url).pathname;
const printer = new URL('../../examples/printers/tower.toml', import.meta.url).pathname;
let folder;
let browser;
let twin;
let studio;

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_port_'));
  execFileSync(program, ['slice', robot, '--printer', printer, '--layer', '1 mm', '-q', '-o', join(folder, 'finger.zip')]);
  mkdirSync(join(folder, 'light'));
  const at = (name) => join(folder, name);
  twin = spawn(program, ['twin', '--printer', printer, '--pty', at('printer'), '--projector', at('light'), '--clock', at('clock'), '--speed', '200', '-q'], { stdio: 'ignore' });
  for (let k = 0; k < 100 && !(existsSync(at('printer')) && existsSync(at('clock'))); ++k) await pause(100);
  studio = await startStudio(['finger.zip'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  twin?.kill('SIGTERM');
  rmSync(folder, { recursive: true, force: true });
});

async function connect(page, state) {
  await page.getByTestId('device').fill(realpathSync(join(folder, 'printer')));
  await page.getByTestId('projector').fill('light');
  await page.locator('summary', { hasText: 'virtual printer on this port' }).click();
  await page.getByTestId('port-speed').fill('200');
  await page.getByTestId('port-clock').fill('clock');
  const [answer] = await Promise.all([
    page.waitForResponse((r) => r.url().endsWith('/api/print/port')),
    page.getByTestId('take-port').click(),
  ]);
  if (!answer.ok()) assert.fail(await answer.text());
  await page.waitForSelector('[data-testid=print-state]');
  await shown(page, (s) => document.querySelector('[data-testid=print-state]').textContent === s, state);
}
/// Waits for what the page shall show of the print; what it says instead is told where it fails.
async function shown(page, check, given) {
  await page.waitForFunction(check, given, { timeout: 90000 }).catch(async () => assert.fail(await page.locator('.steer').innerText()));
}
const layer = (page) => page.getByTestId('print-layer').textContent().then(Number);

/// On a phone nothing covers the machine, and no name of its parts is cut.
async function readableOnPhone(page) {
  const size = page.viewportSize();
  await page.setViewportSize({ width: 390, height: 844 });
  await shown(page, () => {
    const box = (e) => e.getBoundingClientRect();
    const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
    const names = [...document.querySelectorAll('.names span')].filter((e) => e.style.visibility === 'visible').map(box);
    const over = [...document.querySelectorAll('.watch .picture, .watch .view-of, .watch .part-caption')].map(box);
    const canvas = box(document.querySelector('.machine-view canvas'));
    return canvas.width <= 390 && over.every((o) => apart(canvas, o)) && names.length >= 3 && names.every((n) => n.left >= 0 && n.right <= 390);
  });
  await page.setViewportSize(size);
}

test('a file that is not a serial port, and a job that is not saved, are refused', async (t) => {
  const { page } = await openPage(browser, `${studio.address}#print`, t);
  await page.getByTestId('device').fill('/etc/passwd');
  await page.getByTestId('projector').fill('light');
  await page.getByTestId('take-port').click();
  await page.waitForSelector('[data-testid=notice]');
  assert.match(await page.getByTestId('notice').textContent(), /not a serial port/);
  const outside = await page.evaluate(async (device) => {
    const answer = await fetch('/api/print/port', { method: 'POST', headers: { 'X-Pliant-Page': window.pliant.page }, body: JSON.stringify({ device, projector: '../light' }) });
    return [answer.status, (await answer.json()).error];
  }, realpathSync(join(folder, 'printer')));
  assert.equal(outside[0], 422);
  assert.match(outside[1], /leads elsewhere/);
});

test('a print at a port survives the end of the studio, and is resumed from the page', async (t) => {
  const first = await openPage(browser, `${studio.address}#print`, t);
  await connect(first.page, 'Operational');
  assert.match(await first.page.getByTestId('known').textContent(), /responds: Pliant twin/);
  for (const box of await first.page.locator('.checklist input').all()) await box.check();
  await first.page.getByTestId('start').click();
  await first.page.waitForFunction(() => Number(document.querySelector('[data-testid=print-layer]').textContent) >= 2);
  await readableOnPhone(first.page);
  const broken = await layer(first.page);
  studio.child.kill('SIGKILL');
  await first.context.close();
  for (let k = 0; k < 50 && existsSync(join(folder, 'light', 'shown.png')); ++k) await pause(100);
  assert.ok(!existsSync(join(folder, 'light', 'shown.png')), 'no light outlives the studio');

  studio = await startStudio([], folder);
  const { page, wrong } = await openPage(browser, `${studio.address}#print`, t);
  const line = page.getByTestId('journals').locator('button', { hasText: 'finger' });
  assert.match(await line.textContent(), /interrupted/);
  await line.click();
  assert.match(await page.getByTestId('journal').textContent(), /session.*light.*layer=/s);
  await page.getByTestId('open-interrupted').click();
  await connect(page, 'Offline');  // nobody speaks to it before it goes on
  await page.getByTestId('interrupted').waitFor();
  assert.equal(await page.getByTestId('start').count(), 0, 'nothing is begun anew over a print that waits');
  await page.getByTestId('go-on').click();
  await shown(page, (l) => Number(document.querySelector('[data-testid=print-layer]').textContent) > l, broken);
  await shown(page, () => document.querySelector('[data-testid=print-state]').textContent === 'Printed');
  // What the first studio had exposed is remembered by the journal: the part is whole.
  await shown(page, () => Math.abs(Number(document.querySelector('[data-testid=part]')?.dataset.height) - window.pliant.job.value.manifest.layers.at(-1).z_um / 1000) < 1e-3);
  await says(page.getByTestId('part'), /12\.00 mm exposed; whether it cured is unknown/);
  const journal = readFileSync(join(folder, 'finger.zip.journal'), 'utf8');
  const lights = [...journal.matchAll(/ light step=\d+ layer=(\d+)/g)].map((m) => Number(m[1]));
  const layers = await page.evaluate(() => window.pliant.job.value.manifest.layers.length);
  assert.equal(new Set(lights).size, layers, 'every layer has had its light');
  assert.equal([...journal.matchAll(/ session /g)].length, 2);
  assert.match(journal, / end\b/);
  const report = await page.evaluate(async () => (await fetch('/api/print/report')).text());
  assert.match(report, /1<\/b><span>fault|2<\/b><span>faults/);
  assert.match(report, /survived: the light went on in layer/);
  execFileSync(program, ['print', join(folder, 'finger.zip'), '--report', join(folder, "report.html")], { stdio: "inherit" });
  assert.match(readFileSync(join(folder, 'report.html'), 'utf8'), /survived: the light went on in layer/);
  await page.getByTestId('leave').click();
  await page.getByTestId('take-port').waitFor();
  assert.deepEqual(wrong, []);
});
