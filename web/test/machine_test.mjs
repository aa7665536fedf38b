// What watches over a print, and what it asks of people: the door, the switches, vats that run empty. On the virtual
// printer of the studio; and the part that grows meanwhile.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, program, startBrowser, startPrint as start, startStudio, takeTwin } from './studio.mjs';

// 20 layers of 20 x 10 mm: 0.4 ml. The vat gives 0.25 ml at a time.
const robot = `name = "plate"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45, resin = "semi-flex" }
body = [{ name = "plate", material = "soft", geometry = { box = [[0, 0, 0], [20, 10, 2]] } }]
fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 2]] }]
mesh = { size = "4 mm" }
`;
const single = new URL('../../examples/printers/single.toml', import.meta.url).pathname;
let folder;
let browser;
let studio;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_machine_'));
  writeFileSync(join(folder, 'plate.toml'), robot);
  const vat = 'fill = "150 ml"';
  const printer = readFileSync(single, 'utf8');
  assert.ok(printer.includes(vat));
  writeFileSync(join(folder, 'small.toml'), printer.replace(vat, 'fill = "20.25 ml"'));
  execFileSync(program, ['slice', join(folder, 'plate.toml'), '--printer', join(folder, 'small.toml'), '--layer', '100 um', '-q', '-o', join(folder, 'plate.zip')]);
  studio = await startStudio(['plate.zip'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  rmSync(folder, { recursive: true, force: true });
});

const text = (page, id) => page.getByTestId(id).textContent();
const layer = (page) => text(page, 'print-layer').then(Number);
/// Waits for what the page shall show; what it shows instead is told where it fails.
async function shown(page, check, given) {
  await page.waitForFunction(check, given, { timeout: 60000 }).catch(async () => assert.fail(await page.locator('.steer').innerText()));
}
const beyond = (page, l) => shown(page, (k) => Number(document.querySelector('[data-testid=print-layer]').textContent) > k, l);
const state = (page, id, value) => shown(page, ([i, v]) => document.querySelector(`[data-testid="${i}"]`)?.dataset.state === v, [id, value]);

/// How many pixels of the 3D view have the hue of the job's material.
async function coloured(page) {
  const png = (await page.getByTestId('machine-view').screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const g = Object.assign(document.createElement('canvas'), { width: image.width, height: image.height }).getContext('2d');
    g.drawImage(image, 0, 0);
    const pixels = g.getImageData(0, 0, image.width, image.height).data;
    const hue = (r, gr, b) => [r, gr, b].map((v) => (v - Math.min(r, gr, b)) / Math.max(1, Math.max(r, gr, b) - Math.min(r, gr, b)));
    const c = parseInt(window.pliant.job.value.colours[0].slice(1), 16);
    const wanted = hue(c >> 16, (c >> 8) & 255, c & 255);
    let n = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      const [r, gr, b] = pixels.slice(i, i + 3);
      if (Math.max(r, gr, b) - Math.min(r, gr, b) < 40) continue;
      if (hue(r, gr, b).every((v, k) => Math.abs(v - wanted[k]) < 0.15)) ++n;
    }
    return n;
  }, png);
}

/// The same once it is more than `least`: a busy machine draws later than the page knows. What is seen after 30 s otherwise.
async function colouredAbove(page, least) {
  const end = Date.now() + 30000;
  for (;;) {
    const seen = await coloured(page);
    if (seen > least || Date.now() > end) return seen;
    await page.waitForTimeout(250);
  }
}

test('an open door pauses the print with a message; an empty vat asks for resin; the part grows, and the report inspects it', async (t) => {
  const { page, wrong } = await openPage(browser, `${studio.address}#print`, t);
  await takeTwin(page, '10');
  // Before the start: what is listed is known, and an open door is no beginning.
  await state(page, 'door', 'shut');
  await state(page, 'switch-z_max', 'free').catch(() => state(page, 'switch-z_max', 'pressed'));
  assert.match(await text(page, 'emergency-line'), /none: an emergency stop relies on the firmware/);
  assert.match(await text(page, 'known'), /the print will pause once for a refill: layer 1\d, refill the vat of slot 1/);
  assert.match(await text(page, 'check-slot1'), /slot 1 holds at least 21 ml of semi-flex/); // of which 20 must stay
  for (const box of await page.locator('.checklist input').all()) await box.check();
  await page.getByTestId('move-door').click();
  await state(page, 'door', 'open');
  assert.ok(await page.getByTestId('start').isDisabled());
  assert.match(await text(page, 'start'), /Close the door/);
  const refused = await page.evaluate(async () => {
    const answer = await fetch('/api/print/host/job', { method: 'POST', headers: { 'X-Pliant-Page': window.pliant.page }, body: '{"command":"start"}' });
    return [answer.status, (await answer.json()).error];
  });
  assert.deepEqual(refused, [409, 'the door is open: close it, then start']);
  await page.getByTestId('move-door').click();
  await state(page, 'door', 'shut');

  await page.getByTestId('start').click();
  await beyond(page, 2);
  await page.getByTestId('move-door').click();
  await page.getByTestId('resume').waitFor();
  assert.match(await text(page, 'prompt'), /The door is open.*Close the door; then the print can be resumed/);
  assert.ok(await page.getByTestId('resume').isDisabled(), 'nothing goes on behind an open door');
  assert.equal(await page.locator('.picture.lit').count(), 0);
  const stopped = await layer(page);
  await page.waitForTimeout(1500); // five layers on the machine's clock
  assert.equal(await layer(page), stopped);
  await page.getByTestId('move-door').click();
  await shown(page, () => /closed again/.test(document.querySelector('[data-testid=prompt]').textContent));
  assert.equal(await text(page, 'print-state'), 'Paused', 'it does not go on by itself');
  await page.getByTestId('resume').click();
  await beyond(page, stopped);
  // What has cured is seen, as soon as the page has drawn it.
  await shown(page, (mm) => Number(document.querySelector('[data-testid=part]')?.dataset.height ?? 0) >= mm, (stopped - 1) * 0.1 - 1e-6);

  await shown(page, () => /Resin is needed/.test(document.querySelector('[data-testid=prompt]')?.textContent ?? ''));
  assert.match(await text(page, 'prompt'), /Fill the vat of slot 1 with semi-flex, up to 20 ml/);
  assert.match(await text(page, 'resume'), /Filled, resume/);
  const dry = await layer(page);
  await page.getByTestId('resume').click();
  await beyond(page, dry);
  await shown(page, () => document.querySelector('[data-testid=print-state]').textContent === 'Printed');
  await shown(page, () => Math.abs(Number(document.querySelector('[data-testid=part]').dataset.height) - 2) < 1e-3);
  assert.match(await text(page, 'part'), /2\.00 mm cured in the virtual printer/);
  const cells = await page.evaluate(() => Number(document.querySelector('[data-testid=part]').dataset.runs));
  assert.ok(cells > 100 && cells < 40000, `${cells} runs of cells`);

  await page.getByTestId('verdict').waitFor({ timeout: 60000 });
  assert.match(await text(page, 'verdict'), /As drawn/);
  const report = await page.evaluate(async () => (await fetch('/api/print/report')).text());
  assert.match(report, /pill good">as drawn/, report.match(/First deviation[^<]*/)?.[0]);
  assert.match(report, /<td>400\.000 mm³<\/td>/);
  assert.match(report, /alt="Drawing and cured block" src="data:image\/png;base64,/);
  assert.match(report, /door/);
  assert.deepEqual(wrong.filter((w) => !w.includes('409')), []);
});

test('a second print on the same machine begins with an empty platform; the part can be viewed alone', async (t) => {
  const { page, wrong } = await openPage(browser, `${studio.address}#print`, t);
  await page.waitForSelector('[data-testid=print-state]');
  await page.waitForSelector('[data-testid=part]');
  await page.getByTestId('view-part').click();
  await start(page);
  await shown(page, () => !document.querySelector('[data-testid=part]') || Number(document.querySelector('[data-testid=part]').dataset.height) < 1);
  await shown(page, () => !(Number(document.querySelector('[data-testid=print-layer]').textContent) > 4)); // no longer the last of the first print
  await beyond(page, 4);
  await page.getByTestId('pause').click();
  await page.getByTestId('resume').waitFor();
  assert.equal(await page.locator('.picture.lit').count(), 0);
  const stopped = await layer(page);
  await shown(page, (mm) => Number(document.querySelector('[data-testid=part]')?.dataset.height ?? 0) >= mm, (stopped - 1) * 0.1 - 1e-6);
  const near = await colouredAbove(page, 2000);
  assert.ok(near > 2000, `${near} pixels of the part when it is looked at alone`);
  // A page that comes later sees the same part.
  const other = await openPage(browser, `${studio.address}#print`, t);
  await shown(other.page, () => Number(document.querySelector('[data-testid=part]')?.dataset.height ?? 0) > 0);
  await page.getByTestId('cancel').click();
  await page.getByTestId('cancel-sure').click();
  await page.getByTestId('leave').waitFor({ timeout: 60000 });
  await page.getByTestId('leave').click();
  await page.getByTestId('take-twin').waitFor();
  assert.deepEqual([...wrong, ...other.wrong], []);
});
