// The page shows what is so, says what it does not know, and loses nothing that a person has typed.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, program, says, settled, startBrowser, startPrint, startStudio, takeTwin, readRobot, typeRobot } from './studio.mjs';

const example = (name) => new URL(`../../examples/${name}`, import.meta.url).pathname;
const patience = { timeout: 90_000 };
let folder;
let browser;
let studio;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_truth_'));
  copyFileSync(example('tutorial/finger.toml'), join(folder, 'finger.toml'));
  execFileSync(program, ['slice', join(folder, 'finger.toml'), '--printer', example('printers/tower.toml'), '--layer', '1 mm', '-q', '-o', join(folder, 'finger.zip')]);
  studio = await startStudio(['finger.toml'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  rmSync(folder, { recursive: true, force: true });
});

const text = (page, id) => page.getByTestId(id).textContent();
const head = (page) => page.evaluate(() => window.pliant.frame.value.head);
/// A print that has begun, and goes on as slowly as a real one. On a busy machine the page can take longer to slow it
/// down than the whole of it lasts at 300 times: hence 60.
async function printing(page) {
  await takeTwin(page, '60');
  await startPrint(page);
  await page.waitForFunction(() => Number(document.querySelector('[data-testid=print-layer]')?.textContent) >= 1, null, patience);
  await page.getByRole('button', { name: '1×', exact: true }).click();
  await page.waitForSelector('button[aria-pressed=true]:text-is("1×")');
  assert.equal(await text(page, 'print-state'), 'Printing');
}
/// Types into a field and leaves it, as people do.
async function type(page, id, value) {
  await page.getByTestId(id).fill(value);
  await page.getByTestId(id).press('Enter');
}

test('a studio is killed during a print and started again: the page shows unknown values, then the true ones', async (t) => {
  const first = await startStudio(['finger.zip'], folder);
  const port = new URL(first.address).port;
  const { page } = await openPage(browser, `${first.address}#print`, t);
  await printing(page);
  first.child.kill('SIGKILL');
  await page.getByTestId('lost').waitFor(patience);
  assert.match(await text(page, 'lost'), /Connection lost, reconnecting/);
  assert.equal(await text(page, 'print-state'), 'Unknown');
  assert.equal(await text(page, 'print-layer'), '–');
  assert.ok(await page.getByTestId('pause').isDisabled());
  assert.ok(await page.getByTestId('cancel').isDisabled());
  assert.equal(await page.locator('.picture.lit').count(), 0);
  // Without a job: neither print nor job of the studio before are there any more.
  const second = await startStudio(['finger.toml'], folder, port);
  t.after(() => second.stop());
  await page.getByText('There is no job yet').waitFor(patience);
  assert.equal(await page.getByTestId('print-state').count(), 0);
  assert.equal(await page.getByTestId('emergency').count(), 0, 'there is no machine to stop');
  assert.match(await text(page, 'notice'), /was interrupted.*the print history can resume it/);
});

test('a connection that stops without closing is found lost by its silence', async (t) => {
  const other = await startStudio(['finger.zip'], folder);
  t.after(() => other.stop());
  const { page } = await openPage(browser, `${other.address}#print`, t);
  await printing(page);
  other.child.kill('SIGSTOP');
  t.after(() => other.child.kill('SIGCONT'));
  await page.getByTestId('lost').waitFor(patience);
  other.child.kill('SIGCONT');
  await page.getByTestId('lost').waitFor({ state: 'detached', ...patience });
  assert.equal(await text(page, 'print-state'), 'Printing');
  assert.ok(Number(await text(page, 'print-layer')) >= 1);
});

test('the emergency stop keeps its place at every width, with any dialog open, however far the page is scrolled', async (t) => {
  const other = await startStudio(['finger.zip'], folder);
  t.after(() => other.stop());
  const { page } = await openPage(browser, `${other.address}#print`, t, { viewport: { width: 1440, height: 900 } });
  assert.equal(await page.getByTestId('emergency').count(), 0);
  await printing(page);
  const seen = async (width, height) => {
    const box = await page.getByTestId('emergency').boundingBox();
    assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= width && box.y + box.height <= height, `${width}: ${JSON.stringify(box)}`);
    const hit = await page.evaluate(([x, y]) => document.elementFromPoint(x, y)?.dataset.testid, [box.x + box.width / 2, box.y + box.height / 2]);
    assert.equal(hit, 'emergency', `${width}: something lies over it`);
    // Nor does it lie over anything that can be pressed.
    const under = await page.evaluate((b) =>
      [...document.querySelectorAll('header a, header button')]
        .filter((e) => e.checkVisibility())
        .map((e) => [e.getBoundingClientRect(), e.textContent])
        .filter(([r]) => r.left < b.x + b.width && r.right > b.x && r.top < b.y + b.height && r.bottom > b.y)
        .map(([, name]) => name), box);
    assert.deepEqual(under, [], `${width}`);
    return box;
  };
  for (const [width, height] of [[1440, 900], [1280, 720], [1024, 700], [390, 844]]) {
    await page.setViewportSize({ width, height });
    await page.waitForTimeout(200);
    const before = await seen(width, height);
    await page.getByTestId('cancel').click();
    await page.getByTestId('cancel-sure').waitFor();
    assert.deepEqual(await seen(width, height), before, `${width}: after Cancel was pressed`);
    await page.getByRole('button', { name: 'Keep printing' }).click();
    await page.evaluate(() => document.querySelectorAll('.print, .steer').forEach((e) => e.scrollTo(0, 1e5)));
    assert.deepEqual(await seen(width, height), before, `${width}: scrolled`);
    for (const section of ['simulate', 'make', 'print']) {
      await page.getByTestId(`section-${section}`).click();
      assert.deepEqual(await seen(width, height), before, `${width}: ${section}`);
    }
  }
  await page.getByTestId('emergency').click();
  await page.getByTestId('stopped').waitFor(patience);
  assert.equal(await text(page, 'print-state'), 'Emergency stop');
  assert.match(await text(page, 'stopped'), /light is off.*then press (Resume|Reconnect)/);
  assert.doesNotMatch(await page.locator('.steer .block').first().innerText(), /kill\(\)/);
});

test('log, header and layers agree in layer numbers and time; a finished print has a verdict', async (t) => {
  const other = await startStudio(['finger.zip'], folder);
  t.after(() => other.stop());
  const { page, wrong } = await openPage(browser, `${other.address}#print`, t);
  await takeTwin(page, '300');
  await startPrint(page);
  await page.waitForFunction(() => document.querySelector('[data-testid=print-state]')?.textContent === 'Printed', null, patience);
  const layers = await page.evaluate(() => window.pliant.job.value.manifest.layers.length);
  assert.equal(Number(await text(page, 'print-layer')), layers);
  const rows = await page.getByTestId('log').locator('li').evaluateAll((list) => list.map((li) => [li.className, li.children[0].textContent, li.children[1].textContent]));
  const lights = rows.filter(([kind]) => kind === 'light');
  assert.match(lights.at(-1)[2], new RegExp(`^layer ${layers}, `));
  const names = await page.evaluate(() => window.pliant.job.value.manifest.materials.map((m) => m.name));
  for (const [, , line] of lights) assert.ok(names.some((n) => line.includes(`, ${n}, `)), line);
  for (const [kind, , line] of rows.filter(([k]) => k === 'layer')) assert.match(line, /^layer [1-9]/, kind);
  // The log ends when the time elapsed does.
  const seconds = (s) => s.split(':').reduce((sum, v) => 60 * sum + Number(v), 0);
  const elapsed = seconds(await page.locator('.small-figures div', { hasText: 'elapsed' }).locator('b').textContent());
  assert.ok(Math.abs(seconds(lights.at(-1)[1]) - elapsed) < 0.25 * elapsed && elapsed > 60, `${lights.at(-1)[1]} and ${elapsed} s`);
  await page.getByTestId('verdict').waitFor(patience);
  // Layers of 1 mm are ten times what the light cures: it is printed, and worth nothing.
  assert.match(await text(page, 'verdict'), /Not as drawn/);
  assert.deepEqual(wrong, []);
});

test('the page asks before unsaved text is lost', async (t) => {
  const { page } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('tab-file').click();
  await page.waitForFunction(() => window.pliant.robotText.value.includes('youngs_modulus'));
  const good = await readRobot(page);
  const mine = `# a night of work\n${good}`;
  await typeRobot(page, mine);
  const open = async () => {
    await page.getByTestId('open').click();
    await page.locator('.open-list .item', { hasText: 'cable gripper' }).click();
    await page.getByTestId('discard-question').waitFor();
  };
  await open();
  // The keyboard stays in the question, and afterwards returns to where it was.
  const focused = () => page.evaluate(() => document.activeElement?.dataset.testid ?? document.activeElement?.tagName);
  const reached = new Set();
  for (let k = 0; k < 12; ++k) {
    await page.keyboard.press('Tab');
    reached.add(await focused());
  }
  assert.deepEqual([...reached].filter((id) => !['keep-editing', 'discard', 'BODY', 'HTML'].includes(id)), []);
  assert.ok(reached.has('keep-editing') && reached.has('discard'));
  await page.getByTestId('keep-editing').click();
  assert.equal(await page.evaluate(() => document.querySelector('.behind-dialogs').inert), false);
  assert.equal(await readRobot(page), mine);
  // What comes from the studio meanwhile does not take it either.
  await page.getByTestId('fine').click();
  await page.waitForFunction(() => window.pliant.documentState.value.accuracy === 'fine');
  await page.waitForTimeout(500);
  assert.equal(await readRobot(page), mine);
  const asked = page.waitForEvent('dialog');
  const left = page.reload().catch(() => {});
  const dialog = await asked;
  assert.equal(dialog.type(), 'beforeunload');
  await dialog.dismiss();
  await Promise.race([left, page.waitForTimeout(500)]);
  assert.equal(await readRobot(page), mine);
  // Applied, it is in no file yet.
  await page.getByTestId('apply').click();
  await page.waitForFunction(() => window.pliant.documentState.value.unsaved);
  await open();
  await page.getByTestId('discard').click();
  await page.waitForFunction(() => !window.pliant.robotText.value.includes('night of work'));
  await page.waitForFunction(() => /gripper/i.test(window.pliant.scene.value?.head.robot), null, patience);
});

test('during dragging linear answers are marked and never green; afterwards the quadratic answer comes', async (t) => {
  const other = await startStudio(['finger.toml'], folder);
  t.after(() => other.stop());
  const { page } = await openPage(browser, other.address, t);
  await settled(page);
  // Every frame with what the page says beside it.
  await page.evaluate(() => {
    window.seen = [];
    window.pliant.frame.subscribe((f) =>
      requestAnimationFrame(() => {
        const status = document.querySelector('[data-testid=status]');
        if (f === window.pliant.frame.value)
          window.seen.push({ order: f.head.order, reduced: f.head.reduced_error_mm, arrived: f.head.arrived, lamp: status?.dataset.lamp, force: document.querySelector('[data-testid=force-flexor]').textContent, tension: f.head.cables[0].tension_N });
      }),
    );
  });
  const box = await page.locator('#actuator-0').boundingBox();
  await page.mouse.move(box.x + box.width - 9, box.y + box.height / 2);
  await page.mouse.down();
  for (let k = 1; k <= 12; ++k) {
    await page.mouse.move(box.x + box.width - 9 - (k * box.width) / 36, box.y + box.height / 2);
    await page.waitForTimeout(30);
  }
  // Still held: the hand rests, and that is enough.
  await page.waitForFunction(() => window.pliant.frame.value?.head.arrived && window.pliant.frame.value?.head.cables[0].ratio < 0.9, null, patience);
  await page.mouse.up();
  await settled(page);
  assert.equal(await page.getByTestId('status').getAttribute('data-lamp'), 'good');
  assert.doesNotMatch(await text(page, 'force-flexor'), /≈/);
  const seen = await page.evaluate(() => window.seen);
  const rough = seen.filter((s) => s.order === 1 || s.reduced !== undefined);
  assert.ok(rough.length > 0, 'approximate frames were shown');
  for (const s of rough) {
    assert.notEqual(s.lamp, 'good');
    assert.equal(s.arrived, false);
    assert.match(s.force, /^≈/);
  }
  // One frame: where the hand has moved last may still be on its way.
  const there = await page.waitForFunction(() => window.pliant.frame.value?.head.arrived && window.pliant.frame.value?.head.cables[0], null, patience);
  const { ratio, tension_N: shown } = await there.jsonValue();
  const right = JSON.parse(execFileSync(program, ['simulate', join(folder, 'finger.toml'), '--json', '--set', `cable.flexor.target.length_ratio=${ratio}`])).steps.at(-1).cables.flexor.tension_N;
  assert.ok(Math.abs(shown - right) < 0.01 * right, `${shown} N, and it is ${right} N`);
  // What asks for linear elements alone says so.
  await page.getByTestId('preview').click();
  await page.waitForFunction(() => window.pliant.scene.value?.head.order === 1, null, patience);
  await settled(page);
  assert.equal(await page.getByTestId('status').getAttribute('data-lamp'), 'warn');
  assert.match(await text(page, 'rough'), /1\.3 to 3 times too large/);
  // At rest: of the frames of a hand that moves a busy computer may not draw the last, and the hand may since be a little on.
  const linear = (await head(page)).cables[0];
  assert.ok(Math.abs(linear.ratio - ratio) < 0.03 && linear.tension_N > 1.5 * right, `linear elements say ${linear.tension_N} N at ${linear.ratio}, quadratic ones ${right} N at ${ratio}`);
  await page.getByTestId('refine').click();
  await page.waitForFunction(() => window.pliant.scene.value?.head.order === 2, null, patience);
  await settled(page);
  assert.equal(await page.getByTestId('status').getAttribute('data-lamp'), 'good');
  assert.equal(await page.getByTestId('rough').count(), 0);
});

test('the program stops at its end, and a change of material keeps the robot at the program\'s time', async (t) => {
  const other = await startStudio(['finger.toml'], folder);
  t.after(() => other.stop());
  const { page } = await openPage(browser, other.address, t);
  await settled(page);
  const program = page.locator('.track', { has: page.getByTestId('program') }).locator('output');
  await page.getByTestId('play').click();
  await page.waitForFunction(() => window.pliant.frame.value?.head.time > 0.999 && !window.pliant.frame.value?.head.playing, null, patience);
  await says(program, '100 %');
  await page.getByTestId('program').fill('0.97');
  await page.waitForFunction(() => Math.abs(window.pliant.frame.value?.head.time - 0.97) < 1e-9 && window.pliant.frame.value?.head.arrived, null, patience);
  const { markers } = await head(page);
  const revision = await page.evaluate(() => window.pliant.scene.value.head.revision);
  await page.getByTestId('tab-file').click();
  const modulus = page.locator('[data-testid^="modulus-"]').first();
  await modulus.fill(String(1.001 * Number(await modulus.inputValue())));
  await modulus.press('Enter');
  await page.waitForFunction((r) => window.pliant.scene.value?.head.revision > r, revision, patience);
  await page.waitForFunction(() => Math.abs(window.pliant.frame.value?.head.time - 0.97) < 1e-9 && window.pliant.frame.value?.head.arrived, null, patience);
  await says(program, '97 %');
  const after = (await head(page)).markers;
  // Bent by the length of its cable it hardly moves with a modulus that is a thousandth higher.
  after[0].forEach((x, k) => assert.ok(Math.abs(x - markers[0][k]) < 0.5, `${after[0]} was ${markers[0]}`));
  // Another page, and one that is loaded anew, show the same.
  const second = await openPage(browser, other.address, t);
  await settled(second.page);
  await says(second.page.locator('.track', { has: second.page.getByTestId('program') }).locator('output'), '97 %');
});

test('a frame that arrives before its scene is not lost', async (t) => {
  const other = await startStudio(['finger.toml'], folder);
  t.after(() => other.stop());
  const { page } = await openPage(browser, other.address, t);
  await settled(page);
  const revision = await page.evaluate(() => window.pliant.scene.value.head.revision);
  // The studio was asked for a frame when it had none yet, and its answer takes longer than the only frame.
  await page.route('**/api/frame', async (route) => {
    await new Promise((done) => setTimeout(done, 5000));
    await route.fulfill({ status: 200, contentType: 'application/octet-stream', body: '' });
  });
  await page.getByTestId('tab-file').click();
  const modulus = page.locator('[data-testid^="modulus-"]').first();
  await modulus.fill(String(1.001 * Number(await modulus.inputValue())));
  await modulus.press('Enter');
  await page.waitForFunction((r) => window.pliant.scene.value?.head.revision > r, revision, patience);
  await page.waitForFunction(() => window.pliant.frame.value?.head.arrived, null, { timeout: 10_000 });
});

test('an impossible number is reported as out of range, and the last valid one returns', async (t) => {
  const other = await startStudio(['finger.toml'], folder);
  t.after(() => other.stop());
  const { page } = await openPage(browser, other.address, t);
  await settled(page);
  await type(page, 'number-flexor', '-3');
  assert.match(await text(page, 'wrong-number-flexor'), /-3: must be more than 0 and less than 10$/);
  await page.getByTestId('number-flexor').blur();
  assert.equal(await page.getByTestId('number-flexor').inputValue(), '1');
  await page.getByTestId('tab-file').click();
  const modulus = page.locator('[data-testid^="modulus-"]').first();
  const good = await modulus.inputValue();
  await modulus.fill('-1');
  await modulus.press('Enter');
  assert.match(await page.locator('[data-testid^="wrong-modulus-"]').textContent(), /-1: must be more than 0 MPa/);
  await modulus.blur();
  assert.equal(await modulus.inputValue(), good);
  const poisson = page.locator('[data-testid^="poisson-"]').first();
  await poisson.fill('0.7');
  await poisson.blur();
  assert.match(await page.locator('[data-testid^="wrong-poisson-"]').textContent(), /0\.7: must be more than -1 and less than 0\.5/);
  assert.notEqual(await poisson.inputValue(), '0.7');
});

test('a residual over many decades has grid lines that do not merge', async (t) => {
  const { page } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('play').click();
  await page.waitForFunction(() => window.pliant.frame.value?.head.time > 0.5, null, patience);
  await page.getByTestId('tab-plots').click();
  await page.waitForTimeout(500);
  // The share of ink in a column, in the median of many: some of them lie on a line of the grid themselves.
  const share = await page.evaluate(() => {
    const canvas = document.querySelector('.plots .plot:last-child canvas');
    const { width, height } = canvas;
    const shares = Array.from({ length: 41 }, (_, k) => {
      const x = Math.round((0.4 + 0.01 * k) * width);
      const column = canvas.getContext('2d').getImageData(x, 0, 1, height).data;
      let inked = 0;
      for (let y = 0; y < height; ++y) inked += column[4 * y + 3] > 40 ? 1 : 0;
      return inked / height;
    });
    return shares.sort((a, b) => a - b)[20];
  });
  assert.ok(share < 0.2, `${share} of a column is ink`);
});
