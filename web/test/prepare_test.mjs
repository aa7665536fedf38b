// Prepare: supports painted by hand, the part moved and scaled, two jobs compared, layers seen while they are made.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, startBrowser, startStudio, unzipped } from './studio.mjs';

/// A table: a top of 30 x 20 mm on a column in its middle.
const table = `name = "table"
length_unit = "mm"
[material.soft]
youngs_modulus = "1 MPa"
resin = "semi-flex"
[[body]]
name = "table"
material = "soft"
geometry = { union = [{ box = [[12, 7, 0], [18, 13, 10]] }, { box = [[0, 0, 10], [30, 20, 13]] }] }
[mesh]
size = "6 mm"
[[fixed]]
name = "foot"
box = [[12, 7, 0], [18, 13, 0]]
`;
/// The same with a column four times as high.
const tall = table.replace('"table"\nlength', '"tall"\nlength').replace('18, 13, 10]', '18, 13, 40]').replace('[0, 0, 10], [30, 20, 13]', '[0, 0, 40], [30, 20, 43]');

let browser;
let studio;
before(async () => {
  studio = await startStudio();
  writeFileSync(join(studio.folder, 'table.toml'), table);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
});

const post = (page, path, body) =>
  page.evaluate(
    async ([p, b]) => {
      const answer = await fetch(p, { method: 'POST', headers: { 'X-Pliant-Page': window.pliant.page, 'Content-Type': 'application/json' }, body: JSON.stringify(b) });
      return [answer.status, await answer.text()];
    },
    [path, body],
  );

async function withRobot(t, of, name) {
  const opened = await openPage(browser, `${of.address}#make`, t, { viewport: { width: 1280, height: 800 } });
  await post(opened.page, '/api/open', { name: `${name}.toml` });
  await opened.page.waitForFunction((n) => document.querySelector('[data-testid=open] .title').textContent === n, name, { timeout: 90_000 });
  return opened;
}
const withTable = (t) => withRobot(t, studio, 'table');
const revision = (page) => page.evaluate(() => window.pliant.job.value?.revision ?? 0);
async function slice(page) {
  const before = await revision(page);
  await page.getByTestId('slice').click();
  await page.waitForFunction((b) => (window.pliant.job.value?.revision ?? 0) > b && !window.pliant.slicing?.value, before, { timeout: 120_000 });
}
const jobFile = async (page) => (await page.request.get(`${studio.address}api/job/file`)).body();

test('painted supports can be enforced, blocked and erased, and the job keeps them', async (t) => {
  const { page, wrong } = await withTable(t);
  await page.getByTestId('option-layer').fill('500');
  await page.getByTestId('paint').click();
  assert.equal(await page.getByTestId('bed').getAttribute('data-tool'), 'enforce');
  // The view looks up from below now; a stroke along the middle of the picture meets the part.
  await page.getByTestId('brush-block').click();
  await page.getByTestId('brush-radius').fill('10');
  const box = await page.getByTestId('bed-view').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x - 60, y - 30);
  await page.mouse.down();
  await page.mouse.move(x + 60, y - 30, { steps: 8 });
  await page.mouse.up();
  assert.equal(await page.getByTestId('brush-undo').isEnabled(), true, 'a stroke was painted');
  // By the keyboard too: what the middle of the view shows.
  await page.getByTestId('bed-view').focus();
  await page.keyboard.press('Enter');
  const saved = page.waitForEvent('download');
  await page.getByTestId('brush-save').click();
  const csv = readFileSync(await (await saved).path(), 'utf8');
  assert.match(csv, /^wish,x \(mm\),y \(mm\),z \(mm\),nx,ny,nz,radius \(mm\)\nblock,/);
  await page.getByTestId('brush-done').click();
  await slice(page);
  const bytes = await jobFile(page);
  assert.equal(unzipped(bytes, 'supports.csv'), csv, 'the job keeps what was painted');
  assert.equal(JSON.parse(unzipped(bytes, 'settings.json')).supports.support_paint, 'supports.csv');
  const blocked = await page.evaluate(() => window.pliant.job.value.manifest.materials.reduce((sum, m) => sum + m.model_volume_mm3, 0));
  // Without the paint there are more supports.
  await page.getByTestId('make-bed').click();
  await page.getByTestId('paint').click();
  await page.getByTestId('brush-clear').click();
  await page.getByTestId('brush-done').click();
  await slice(page);
  const free = await page.evaluate(() => window.pliant.job.value.manifest.materials.reduce((sum, m) => sum + m.model_volume_mm3, 0));
  assert.ok(free > blocked + 1, `${free} mm³ of part and supports, ${blocked} where they are blocked`);
  assert.throws(() => unzipped(Buffer.alloc(0), 'supports.csv'));
  // And the two are compared: this job, and the one before.
  await page.getByTestId('make-compare').click();
  const rows = page.locator('.compare-table tbody tr');
  await rows.first().waitFor();
  assert.match(await page.locator('.compare-table').innerText(), /part volume/);
  assert.match(await rows.filter({ hasText: 'resin semi-flex' }).innerText(), /\+\d/);
  assert.match(await rows.filter({ hasText: 'layers' }).innerText(), /same/);
  await page.getByTestId('compare-slider').fill('5');
  await page.waitForFunction(() => /only in this job [\d.]*[1-9]/.test(document.querySelector('[data-testid=compare-layer]').textContent), undefined, { timeout: 60_000 });
  assert.deepEqual(wrong, []);
});

test('the slicer moves, scales and copies the part as the platform view shows it', async (t) => {
  const { page, wrong } = await withTable(t);
  await page.getByTestId('make-bed').click();
  await page.getByTestId('option-layer').fill('500');
  await page.getByTestId('group-turn').locator('summary').click();
  await page.getByTestId('option-scale').fill('150');
  await page.keyboard.press('Enter');
  await page.getByTestId('option-at-x').fill('30');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => /45\.0 × 30\.0 × 19\.5 mm/.test(document.querySelector('.layer-info').textContent));
  assert.equal(await page.getByTestId('bed').getAttribute('data-fits'), 'true');
  // Dragged: the number follows.
  const box = await page.getByTestId('bed-view').boundingBox();
  await page.mouse.move(box.x + box.width / 2 + 90, box.y + box.height / 2);
  const at = () => page.evaluate(() => [...document.querySelectorAll('[data-testid^=option-at-]')].map((i) => Number(i.value)));
  const start = await at();
  for (let dx = 40; dx <= 160 && JSON.stringify(await at()) === JSON.stringify(start); dx += 20) {
    await page.mouse.move(box.x + box.width / 2 + dx, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + dx + 30, box.y + box.height / 2 + 10, { steps: 4 });
    await page.mouse.up();
  }
  assert.notDeepEqual(await at(), start, 'dragging the part moves it');
  await page.getByTestId('option-at-x').fill('30');
  await page.keyboard.press('Enter');
  await page.getByTestId('option-at-y').fill('-5');
  await page.keyboard.press('Enter');
  await slice(page);
  const settings = JSON.parse(unzipped(await jobFile(page), 'settings.json'));
  assert.equal(settings.scale, 1.5);
  assert.deepEqual(settings.at_mm, [30, -5]);
  // Outside of the platform the page says so before it is sliced.
  await page.getByTestId('make-bed').click();
  await page.getByTestId('option-at-x').fill('400');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.querySelector('[data-testid=bed]').dataset.fits === 'false');
  await page.getByTestId('reset-placement').click();
  await page.waitForFunction(() => document.querySelector('[data-testid=bed]').dataset.fits === 'true');
  assert.deepEqual(wrong, []);
});

test('the first layers of a large job are shown while it is being sliced', async (t) => {
  // A studio of its own, whose form no earlier job has filled, and so many layers that they last half a minute: the
  // browser may need seconds for its first picture.
  const other = await startStudio();
  t.after(() => other.stop());
  writeFileSync(join(other.folder, 'tall.toml'), tall);
  const { page, wrong } = await withRobot(t, other, 'tall');
  await page.getByTestId('option-layer').fill('1');
  await page.getByTestId('slice').click();
  await page.waitForSelector('[data-testid=under-way] canvas', { timeout: 120_000 });
  assert.ok(await page.getByTestId('cancel-slice').isVisible(), 'it is still being sliced');
  assert.match(await page.getByTestId('under-way').innerText(), /of \d{5} layers/);
  await page.getByTestId('cancel-slice').click();
  await page.getByTestId('slice').waitFor({ timeout: 60_000 });
  assert.equal(await revision(page), 0, 'cancelled, not finished');
  assert.deepEqual(wrong, []);
});

test('the colour of a resin is chosen on the page, and kept in the robot file and in the job', async (t) => {
  const { page, wrong } = await withTable(t);
  await page.getByTestId('option-layer').fill('500');
  await page.getByTestId('group-exposure').locator('summary').click();
  await page.getByTestId('colour-of-soft').fill('#12ab34');
  await page.waitForFunction(() => window.pliant.scene.value?.head.materials[0].colour === '#12ab34', undefined, { timeout: 60_000 });
  assert.match(await page.evaluate(() => window.pliant.robotText.value), /^colour = "#12ab34"$/m);
  await slice(page);
  assert.deepEqual(await page.evaluate(() => window.pliant.job.value.colours), ['#12ab34']);
  assert.equal(JSON.parse(unzipped(await jobFile(page), 'manifest.json')).materials[0].colour, '#12ab34');
  await page.getByTestId('section-simulate').click();
  await page.getByTestId('tab-build').click();
  await page.getByTestId('build-undo').click();
  await page.waitForFunction(() => !/colour/.test(window.pliant.robotText.value), undefined, { timeout: 60_000 });
  assert.deepEqual(wrong, []);
});

test('a job that no longer matches robot or form is marked, here and before it is printed, until it matches again', async (t) => {
  const { page, wrong } = await withTable(t);
  await page.getByTestId('option-layer').fill('200');
  await slice(page);
  const stale = page.getByTestId('stale');
  const staleFor = (what) => page.waitForFunction((w) => document.querySelector('[data-testid=stale]')?.textContent.includes(`(${w})`), what, { timeout: 30_000 });
  assert.equal(await stale.count(), 0, 'it was sliced just now');

  await page.getByTestId('option-layer').fill('100');
  await staleFor('layer height');
  await page.getByTestId('out-of-date').waitFor();
  await page.getByTestId('printer').selectOption('carousel').catch(() => page.getByTestId('printer').selectOption({ index: 1 }));
  await page.waitForFunction(() => /printer/.test(document.querySelector('[data-testid=stale]').textContent));
  await page.getByTestId('printer').selectOption('tower');
  await page.getByTestId('option-layer').fill('200');
  await stale.waitFor({ state: 'detached' });

  // The text of the robot, and back to it.
  assert.deepEqual(await post(page, '/api/robot/set', { changes: [{ key: 'mesh.size', value: '7 mm' }] }), [200, '{}']);
  await staleFor('robot');
  await page.getByTestId('section-print').click();
  assert.match(await page.getByTestId('stale-job').textContent(), /sliced before the last changes \(robot\)/);
  await page.getByTestId('take-twin').click();
  const item = page.getByTestId('check-old');
  await item.waitFor();
  for (const box of await page.locator('.checklist input').all()) await box.check();
  assert.ok(await page.getByTestId('start').isEnabled(), 'it can be meant');
  await item.locator('input').uncheck();
  assert.ok(await page.getByTestId('start').isDisabled());
  await post(page, '/api/robot/undo', {});
  await item.waitFor({ state: 'detached' });
  await page.getByTestId('section-make').click();
  await stale.waitFor({ state: 'detached' });

  // The machine keeps the job with which it was connected.
  await page.getByTestId('option-layer').fill('100');
  await staleFor('layer height');
  const before = await revision(page);
  await stale.getByRole('button').click();
  await page.waitForFunction((b) => window.pliant.job.value.revision > b, before, { timeout: 60_000 });
  await stale.waitFor({ state: 'detached' });
  await page.getByTestId('section-print').click();
  assert.match(await page.getByTestId('check-old').textContent(), /another one: this machine prints the job with which it was connected/);
  await page.getByTestId('leave').click();
  await page.getByTestId('take-twin').waitFor();

  // A page that is loaded again takes the form of the job: nothing has changed.
  await page.reload();
  await page.waitForFunction(() => window.pliant.job.value !== null && window.pliant.scene.value !== null);
  await page.getByTestId('section-make').click();
  await page.getByTestId('option-layer').waitFor();
  assert.equal(await page.getByTestId('stale').count(), 0);
  assert.deepEqual(wrong, []);
});

test('without a layer height of its own a job has that of its printer', async (t) => {
  const coarse = readFileSync(new URL('../../examples/printers/tower.toml', import.meta.url), 'utf8').replace(/^layer_height = .*$/m, 'layer_height = "500 um"');
  writeFileSync(join(studio.folder, 'coarse.toml'), coarse);
  const { page, wrong } = await withTable(t);
  await page.getByTestId('printer').selectOption('tower');
  await page.getByTestId('option-layer').fill('');
  await page.waitForFunction(() => document.querySelector('[data-testid=option-layer]').placeholder === '50');
  await page.getByTestId('printer').selectOption('coarse.toml');
  await page.waitForFunction(() => document.querySelector('[data-testid=option-layer]').placeholder === '500');
  const layers = () => page.evaluate(() => window.pliant.job.value.manifest.layers);
  await slice(page);
  const thick = await layers();
  assert.ok(thick.every((layer) => layer.thickness_um === 500));
  await page.getByTestId('printer').selectOption('tower');
  await slice(page);
  const thin = await layers();
  assert.ok(thin.every((layer) => layer.thickness_um === 50));
  assert.equal(thin.length, 10 * thick.length);
  assert.deepEqual(wrong, []);
});

test('a wrong option is reported at its field before anything is sliced', async (t) => {
  const { page, wrong } = await withTable(t);
  await page.getByTestId('option-layer').fill('0');
  await page.getByTestId('wrong-layer').waitFor();
  await page.getByTestId('option-layer').fill('100');
  await page.getByTestId('wrong-layer').waitFor({ state: 'detached' });
  await page.getByTestId('group-hollow').locator('summary').click();
  await page.getByTestId('option-hollow').fill('2 apples');
  await page.getByTestId('wrong-hollow').waitFor();
  assert.match(await page.getByTestId('wrong-hollow').textContent(), /apples/);
  assert.deepEqual(wrong, []);
});

test('a resin that no vat holds is told at its field in words of the form, which can allow it; another robot begins without it', async (t) => {
  const other = await startStudio();
  t.after(() => other.stop());
  writeFileSync(join(other.folder, 'table.toml'), table);
  writeFileSync(join(other.folder, 'glued.toml'), table.replace('name = "table"\nlength', 'name = "glued"\nlength').replace('semi-flex', 'glue'));
  const { page, wrong } = await withRobot(t, other, 'glued');
  const told = page.getByTestId('wrong-resin');
  await told.waitFor(); // before anything is sliced
  assert.match(await told.textContent(), /^no vat of tower prototype holds the resin "glue" of "soft": .* Choose another resin above, or tick “Fill resins that no vat holds into free vats”\.$/);
  assert.equal(await page.getByLabel('Resin of soft').getAttribute('aria-invalid'), 'true');
  assert.equal(await page.getByTestId('estimate').count(), 0, 'what cannot be printed takes no time');
  await page.getByTestId('option-layer').fill('500');
  await page.getByTestId('option-any-vat').check();
  await page.getByTestId('estimate').waitFor();
  assert.equal(await told.count(), 0);
  await slice(page);
  assert.equal(JSON.parse(unzipped(await (await page.request.get(`${other.address}api/job/file`)).body(), 'manifest.json')).any_vat, true);
  await page.getByTestId('option-any-vat').uncheck();
  await page.waitForFunction(() => /\(resins\)/.test(document.querySelector('[data-testid=stale]').textContent));

  // The error of slicing goes with the robot, and with its text.
  const failed = () => page.evaluate(() => window.pliant.sliceError.value);
  await page.getByTestId('slice').click();
  await page.waitForFunction(() => window.pliant.sliceError.value !== '');
  await post(page, '/api/robot/set', { changes: [{ key: 'mesh.size', value: '7 mm' }] });
  await page.waitForFunction(() => window.pliant.sliceError.value === '');
  await told.waitFor(); // the robot with its new text has that resin too
  await page.getByTestId('slice').click();
  await page.waitForFunction(() => window.pliant.sliceError.value !== '');
  await page.getByTestId('make-bed').click();
  await post(page, '/api/open', { name: 'table.toml' });
  await page.getByTestId('estimate').waitFor();
  assert.equal(await failed(), '');
  assert.equal(await told.count(), 0);
  assert.deepEqual(wrong, []);
});

test('the name of a job file is suggested; without an earlier job there is nothing to compare with', async (t) => {
  const other = await startStudio();
  t.after(() => other.stop());
  writeFileSync(join(other.folder, 'table.toml'), table);
  const { page, wrong } = await withRobot(t, other, 'table');
  await slice(page);
  assert.equal(await page.getByLabel('Name of the job file').inputValue(), 'table.zip');
  await page.getByTestId('make-compare').click();
  assert.match(await page.getByTestId('compare-none').textContent(), /no previous job yet/);
  assert.deepEqual(wrong, []);
});
