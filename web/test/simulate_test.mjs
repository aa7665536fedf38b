// Building and understanding a robot on the page: geometry that is dropped, chambers, the gallery, sweeps, workspaces,
// motions, a second robot beside, films.
import assert from 'node:assert/strict';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, readRobot, settled, startBrowser, startStudio, typeRobot } from './studio.mjs';
import { block, boxStl } from './shapes.mjs';

const example = (name) => new URL(`../../examples/${name}`, import.meta.url).pathname;
const long = { timeout: 120_000 };
let folder;
let studio;
let browser;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_simulate_'));
  copyFileSync(example('tutorial/finger.toml'), join(folder, 'finger.toml'));
  writeFileSync(join(folder, 'block.toml'), block('1 MPa'));
  studio = await startStudio(['block.toml'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  assert.equal(await studio?.stop(), 0);
  rmSync(folder, { recursive: true, force: true });
});

const revision = (page) => page.evaluate(() => window.pliant.scene.value?.head.revision ?? 0);
/// Does it, and waits until the robot has been built anew and is at equilibrium.
async function rebuilt(page, act) {
  const last = await revision(page);
  await act();
  await page.waitForFunction((r) => window.pliant.scene.value?.head.revision > r, last, long);
  await settled(page);
}
const file = (name, text) => ({ name, mimeType: 'application/octet-stream', buffer: Buffer.from(text) });

/// Agrees that unsaved changes are lost, where the page asks.
async function discard(page) {
  const asked = page.getByTestId('discard');
  await page.waitForFunction(() => document.querySelector('[data-testid=discard]') || !document.querySelector('[data-testid=geometry]'));
  if (await asked.isVisible()) await asked.click();
}

test('an STL dropped onto the page becomes a robot, and gets a cable that bends it', async (t) => {
  const own = await startStudio(['block.toml'], folder);
  t.after(() => own.stop());
  const { page, wrong } = await openPage(browser, own.address, t);
  await settled(page);
  // As a browser drops it: a file, wherever the pointer is.
  await page.evaluate((text) => {
    const data = new DataTransfer();
    data.items.add(new File([text], 'my finger.stl'));
    for (const type of ['dragover', 'drop']) document.body.dispatchEvent(new DragEvent(type, { dataTransfer: data, bubbles: true, cancelable: true }));
  }, boxStl([60, 12, 10]));
  await page.getByTestId('geometry-new').waitFor(long);
  assert.match(await page.getByTestId('geometry-size').textContent(), /^60 × 12 × 10 mm$/);
  await page.getByTestId('geometry-unit').selectOption('cm');
  assert.match(await page.getByTestId('geometry-size').textContent(), /^600 × 120 × 100 mm$/);
  await page.getByTestId('geometry-unit').selectOption('mm');
  assert.equal(await page.getByTestId('geometry-side').inputValue(), '-x', 'held at the end of its longest side');
  await rebuilt(page, () => page.getByTestId('geometry-new').click());
  assert.ok(existsSync(join(folder, 'my finger.stl')), 'it is in the project folder');
  const text = await readRobot(page);
  assert.match(text, /geometry = "my finger.stl"/);
  // The cable: three places along the top.
  await page.getByTestId('tab-build').click();
  await page.getByTestId('view').focus();
  await page.keyboard.press('5');
  await page.getByTestId('place-cable').click();
  const at = async (x) => {
    const [left, top] = await page.evaluate((p) => window.pliant.project(p), [x, 6, 10]);
    const box = await page.getByTestId('view').boundingBox();
    return [box.x + left, box.y + top];
  };
  for (const [k, x] of [4, 30, 56].entries()) {
    await page.mouse.click(...(await at(x)));
    await page.waitForFunction((n) => document.querySelector('.placing')?.textContent.includes(n === 1 ? '1 point' : `${n} points`), k + 1);
  }
  await rebuilt(page, () => page.getByTestId('finish-cable').click());
  await page.getByTestId('tab-move').click();
  const number = page.getByTestId('number-cable 1');
  await number.fill('0.9');
  await number.press('Enter');
  await page.waitForFunction(() => Math.abs(window.pliant.frame.value?.head.cables[0].ratio - 0.9) < 1e-6 && window.pliant.frame.value?.head.arrived, undefined, long);
  assert.ok((await page.evaluate(() => window.pliant.frame.value.head.cables[0].tension_N)) > 0.01);
  // All of it is undone, cable first.
  await page.getByTestId('tab-build').click();
  await rebuilt(page, () => page.getByTestId('build-undo').click());
  assert.equal(await readRobot(page), text);
  assert.deepEqual(wrong, []);
});

test('unreadable files, existing files and invalid names are refused in one line', async (t) => {
  const own = await startStudio(['block.toml'], folder);
  t.after(() => own.stop());
  const { page, wrong } = await openPage(browser, own.address, t);
  await settled(page);
  await page.getByTestId('tab-build').click();
  const pick = page.getByTestId('build-geometry');
  const refused = page.getByTestId('geometry-refused');
  for (const [name, content, why] of [
    ['broken.stl', boxStl([1, 1, 1]).slice(0, 200), /^broken\.stl:/],
    ['noise.step', 'nothing', /^noise\.step:/],
    ['.hidden.stl', boxStl([1, 1, 1]), /a plain name/],
    ['notes.txt', 'hello', /is not geometry that Pliant reads/],
  ]) {
    await pick.setInputFiles(file(name, content));
    await refused.waitFor(long);
    assert.match(await refused.textContent(), why);
    assert.ok(!(await refused.textContent()).includes('\n'));
    await page.keyboard.press('Escape');
    await page.getByTestId('geometry').waitFor({ state: 'detached' });
    assert.ok(!existsSync(join(folder, name)), name);
  }
  await pick.setInputFiles(file('part.stl', boxStl([10, 10, 10])));
  await page.getByTestId('geometry-new').waitFor(long);
  await page.keyboard.press('Escape');
  await pick.setInputFiles(file('part.stl', boxStl([12, 10, 10])));
  await page.getByTestId('geometry-keep').click(long);
  assert.equal(readFileSync(join(folder, 'part.stl'), 'utf8'), boxStl([10, 10, 10]), 'nothing is written over unasked');
  await pick.setInputFiles(file('part.stl', boxStl([12, 10, 10])));
  await page.getByTestId('geometry-replace').click(long);
  await page.getByTestId('geometry-new').waitFor(long);
  assert.equal(readFileSync(join(folder, 'part.stl'), 'utf8'), boxStl([12, 10, 10]));
  // Into the robot that is there: another body, in its unit.
  await page.getByTestId('geometry-unit').selectOption('cm');
  // What was typed and not applied is not lost.
  await page.keyboard.press('Escape');
  await page.getByTestId('tab-file').click();
  await typeRobot(page, `${await readRobot(page)}# mine\n`);
  await page.getByTestId('tab-move').click();
  await page.evaluate((text) => {
    const data = new DataTransfer();
    data.items.add(new File([text], 'part.stl'));
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
  }, boxStl([12, 10, 10]));
  await page.getByTestId('geometry-new').waitFor(long);
  await page.getByTestId('geometry-unit').selectOption('cm');
  const before = await readRobot(page);
  await page.getByTestId('geometry-add').click();
  await page.waitForFunction((b) => window.pliant.robotText.value !== b, before);
  assert.match(await readRobot(page), /\n# mine\n/);
  assert.match(await readRobot(page), /\[\[body\]\]\nname = "part"\nmaterial = "dragon-skin-30"\ngeometry = "part.stl"\nplace = \{ scale = 10 \}/);
  assert.deepEqual(wrong.filter((w) => !/422|409/.test(w)), []);
});

/// Without a question, as another page would.
const call = (page, path, type, body) =>
  page.evaluate(([to, kind, text]) => fetch(to, { method: 'POST', headers: { 'Content-Type': kind, 'X-Pliant-Page': sessionStorage.getItem('pliant_page') }, body: text }).then((r) => r.status), [path, type, body]);

test('a new robot gets a name of its own, where the files that it names are found', async (t) => {
  const own = await startStudio(['block.toml'], folder);
  t.after(() => own.stop());
  const { page, wrong } = await openPage(browser, own.address, t);
  await settled(page);
  mkdirSync(join(folder, 'sub'));
  await rebuilt(page, async () => assert.equal(await call(page, '/api/robot/new', 'text/plain', 'robot = "block.toml"\n'), 200));
  await page.getByTestId('tab-file').click();
  await page.getByRole('button', { name: 'Save', exact: true }).click();
  const name = page.getByTestId('save-name');
  await name.fill('');
  await page.keyboard.type('sub/mine.toml');
  await page.keyboard.press('Enter');
  await page.locator('.notice', { hasText: 'block.toml' }).waitFor(long);
  assert.ok(!existsSync(join(folder, 'sub', 'mine.toml')));
  await name.fill('mine.toml');
  await page.keyboard.press('Enter');
  await name.waitFor({ state: 'detached' });
  assert.equal(readFileSync(join(folder, 'mine.toml'), 'utf8'), 'robot = "block.toml"\n');

  // One with a file goes on under another name, and the file stays as it is.
  await page.getByRole('button', { name: 'Save under another name' }).click();
  assert.equal(await name.inputValue(), 'mine_copy.toml');
  await name.press('Enter');
  await name.waitFor({ state: 'detached' });
  await page.waitForFunction(() => window.pliant.documentState.value.name === 'mine_copy.toml');
  assert.equal(readFileSync(join(folder, 'mine_copy.toml'), 'utf8'), 'robot = "block.toml"\n');
  assert.deepEqual(wrong.filter((w) => !/422/.test(w)), []);
});

test('what belongs to one robot does not go over to another: a pinned state, a recording, what was found', async (t) => {
  const own = await startStudio(['block.toml'], folder);
  t.after(() => own.stop());
  const { page, wrong } = await openPage(browser, own.address, t);
  await settled(page);
  await page.getByTestId('pin').click();
  // A marker of another name is not the pinned one.
  await page.getByTestId('tab-file').click();
  await typeRobot(page, (await readRobot(page)).replace('name = "tip"', 'name = "end"'));
  await rebuilt(page, () => page.getByTestId('apply').click());
  await page.getByTestId('tab-move').click();
  assert.match(await page.locator('.pinned-row').textContent(), /^tip pinned/);
  await page.getByRole('button', { name: 'Record a program' }).click();
  await page.waitForTimeout(700);
  await page.getByRole('button', { name: 'Stop recording' }).click();
  await page.getByRole('button', { name: /samples as program/ }).waitFor();
  await page.getByTestId('tab-sweep').click();
  await page.getByTestId('sweep-0-key').selectOption('material.soft.youngs_modulus');
  await page.getByTestId('sweep-0-count').fill('1');
  await page.getByTestId('sweep-0-count').press('Enter');
  await page.getByTestId('find-sweep').click();
  await page.getByTestId('sweep-found').waitFor(long);
  await rebuilt(page, async () => assert.equal(await call(page, '/api/open', 'application/json', '{"name":"finger.toml"}'), 200));
  await page.getByTestId('sweep-found').waitFor({ state: 'detached' });
  assert.equal(await page.getByTestId('pinned').count(), 0);
  assert.equal(await page.getByRole('button', { name: /samples as program/ }).count(), 0);
  assert.deepEqual(wrong, []);
});

test('an applied change is saved by itself once the robot was built from it', async (t) => {
  writeFileSync(join(folder, 'kept.toml'), block('1 MPa'));
  const own = await startStudio(['kept.toml'], folder);
  t.after(() => own.stop());
  const { page, wrong } = await openPage(browser, own.address, t);
  await settled(page);
  await page.getByTestId('tab-file').click();
  await page.getByTestId('autosave').check();
  const there = () => readFileSync(join(folder, 'kept.toml'), 'utf8');
  await typeRobot(page, block('2 MPa').replace('length = 40', 'length = 0'));
  await page.getByTestId('apply').click();
  await page.getByTestId('problems').waitFor(long);
  await page.waitForTimeout(500);
  assert.equal(there(), block('1 MPa'), 'not with an error');
  await typeRobot(page, block('2 MPa'));
  await rebuilt(page, () => page.getByTestId('apply').click());
  for (let k = 0; k < 100 && there() !== block('2 MPa'); ++k) await page.waitForTimeout(50);
  assert.equal(there(), block('2 MPa'));
  await page.getByTestId('autosave').uncheck();
  assert.deepEqual(wrong, []);
});

test('a file that was changed elsewhere is saved over only after a question', async (t) => {
  writeFileSync(join(folder, 'shared.toml'), block('1 MPa'));
  const own = await startStudio(['shared.toml'], folder);
  t.after(() => own.stop());
  const { page, wrong } = await openPage(browser, own.address, t);
  await settled(page);
  await page.getByTestId('tab-file').click();
  const there = () => readFileSync(join(folder, 'shared.toml'), 'utf8');
  const asked = page.getByTestId('changed-question');
  const changed = async (modulus) => {
    await typeRobot(page, block(modulus));
    await rebuilt(page, () => page.getByTestId('apply').click());
    writeFileSync(join(folder, 'shared.toml'), `# a colleague\n${block('5 MPa')}`);
    await page.getByRole('button', { name: 'Save', exact: true }).click();
    await asked.waitFor();
    const { card, buttons } = await asked.evaluate((e) => ({ card: e.getBoundingClientRect().right, buttons: [...e.querySelectorAll('button')].map((b) => b.getBoundingClientRect().right) }));
    assert.ok(buttons.every((right) => right < card), 'the buttons fit');
  };
  await changed('2 MPa');
  await page.getByTestId('keep-unsaved').click();
  await asked.waitFor({ state: 'detached' });
  assert.match(there(), /^# a colleague/);
  await changed('3 MPa');
  await page.getByTestId('overwrite').click();
  await page.waitForFunction(() => !document.querySelector('[data-testid=changed-question]'));
  for (let k = 0; k < 100 && there() !== block('3 MPa'); ++k) await page.waitForTimeout(50);
  assert.equal(there(), block('3 MPa'));
  await changed('4 MPa');
  await rebuilt(page, () => page.getByTestId('open-again').click());
  assert.match(await readRobot(page), /^# a colleague\n(.|\n)*"5 MPa"/);
  assert.deepEqual(wrong.filter((w) => !/409/.test(w)), []);
});

test('where the question is answered by not saving, it comes again only with another change', async (t) => {
  writeFileSync(join(folder, 'theirs.toml'), block('1 MPa'));
  const own = await startStudio(['theirs.toml'], folder);
  t.after(() => own.stop());
  const { page } = await openPage(browser, own.address, t);
  await settled(page);
  await page.getByTestId('tab-file').click();
  await page.getByTestId('autosave').check();
  writeFileSync(join(folder, 'theirs.toml'), `# a colleague\n${block('5 MPa')}`);
  const asked = page.getByTestId('changed-question');
  await typeRobot(page, block('2 MPa'));
  await rebuilt(page, () => page.getByTestId('apply').click());
  await asked.waitFor();
  await page.getByTestId('keep-unsaved').click();
  await asked.waitFor({ state: 'detached' });
  await typeRobot(page, block('2 MPa').replace('length = 40', 'length = 0'));
  await page.getByTestId('problems').waitFor(long); // the typed text has been checked
  await typeRobot(page, block('3 MPa'));
  await page.getByTestId('problems').waitFor({ state: 'detached' });
  await page.waitForTimeout(500);
  assert.equal(await asked.count(), 0, 'nothing has been applied');
  await rebuilt(page, () => page.getByTestId('apply').click());
  await asked.waitFor();
  await page.getByTestId('keep-unsaved').click();
  await page.getByTestId('autosave').uncheck();
});

test('text that was not applied stays with its robot when another page opens another one', async (t) => {
  writeFileSync(join(folder, 'mine.toml'), block('1 MPa'));
  writeFileSync(join(folder, 'other.toml'), block('7 MPa').replace('"block"', '"other"'));
  const own = await startStudio(['mine.toml'], folder);
  t.after(() => own.stop());
  const { page, wrong } = await openPage(browser, own.address, t);
  await settled(page);
  await page.getByTestId('tab-file').click();
  const mine = `# typed\n${block('1 MPa')}`;
  await typeRobot(page, mine);
  // Another page takes over, and opens another robot.
  const second = await openPage(browser, own.address, t);
  await second.page.waitForSelector('[data-testid=helm][data-state=watching]');
  await second.page.evaluate(() => window.pliant.send({ type: 'steer', action: 'ask' }));
  await page.evaluate(() => window.pliant.send({ type: 'steer', action: 'give' }));
  await second.page.waitForSelector('[data-testid=helm][data-state=steering]', { state: 'attached' });
  const open = (p, name) => p.evaluate((n) => window.pliant.post('/api/open', { name: n }), name);
  await open(second.page, 'other.toml');
  const kept = page.getByTestId('kept-text');
  await kept.waitFor();
  assert.match(await kept.textContent(), /mine\.toml that was not applied is kept/);
  assert.match(await readRobot(page), /"7 MPa"/);
  await second.page.evaluate(() => window.pliant.send({ type: 'steer', action: 'leave' }));
  await second.context.close();
  await page.waitForFunction(() => window.pliant.helm.value.you);
  assert.ok(await page.getByTestId('apply').isDisabled());
  await page.getByTestId('kept-open').click();
  await page.waitForFunction((m) => window.pliant.robotText.value === m, mine);
  assert.equal(await page.evaluate(() => window.pliant.documentState.value.name), 'mine.toml');
  await kept.waitFor({ state: 'detached' });
  assert.deepEqual(wrong, []);
});

test('a chamber is made from a drawn box or from a cavity clicked on, and both can be undone', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  const before = await readRobot(page);
  await page.getByTestId('tab-build').click();
  await page.getByTestId('view').focus();
  await page.keyboard.press('5');
  const click = async (p) => {
    const [left, top] = await page.evaluate((q) => window.pliant.project(q), p);
    const box = await page.getByTestId('view').boundingBox();
    await page.mouse.click(box.x + left, box.y + top);
  };
  await page.getByTestId('place-chamber').click();
  await page.getByTestId('chamber-box').click();
  await page.getByTestId('box-x').fill('8');
  for (const axis of ['y', 'z']) await page.getByTestId(`box-${axis}`).fill('4');
  await page.getByTestId('box-z').press('Enter');
  await click([32, 6, 12]);
  await page.waitForFunction(() => !document.querySelector('[data-testid=make-box]').disabled);
  await rebuilt(page, () => page.getByTestId('make-box').click());
  const corners = /\[\[chamber\]\]\nname = "chamber 1"\ngeometry = \{ box = \[\[([^\]]+)\], \[([^\]]+)\]\] \}/.exec(await readRobot(page));
  const [low, high] = [corners[1], corners[2]].map((s) => s.split(',').map(Number));
  assert.ok(Math.abs(high[0] - low[0] - 8) < 1e-6 && Math.abs(high[2] - 10) < 0.05 && Math.abs((low[0] + high[0]) / 2 - 32) < 2, `${low} to ${high}`);
  assert.ok((await page.evaluate(() => window.pliant.scene.value.head.actuators.some((a) => a.name === 'chamber 1'))));
  // The cavity, through the section that cuts it open.
  await page.getByRole('button', { name: 'Section' }).click();
  await page.locator('.popover .segments button', { hasText: 'z' }).click();
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Section' }).click();
  await page.getByTestId('place-chamber').click();
  await page.getByTestId('chamber-cavity').click();
  await rebuilt(page, () => click([14, 6, 4]));
  assert.match(await readRobot(page), /name = "chamber 2"\ninside = \[/);
  for (let k = 0; k < 2; ++k) await rebuilt(page, () => page.getByTestId('build-undo').click());
  assert.equal(await readRobot(page), before);
  // One that does not fit into the body is reported here, and undone.
  await page.getByTestId('place-chamber').click();
  await page.getByTestId('chamber-ball').click();
  await page.getByTestId('place-radius').fill('40');
  await page.getByTestId('place-radius').press('Enter');
  await click([14, 6, 4]);
  await page.getByTestId('build-problems').waitFor();
  assert.match(await page.getByTestId('build-problems').textContent(), /has an error.*chamber 1.*belong to no body/);
  await page.getByTestId('build-undo-problem').click();
  await page.getByTestId('build-problems').waitFor({ state: 'detached' });
  assert.equal(await readRobot(page), before);
  assert.deepEqual(wrong, []);
});

test('the gallery shows the robots that can be opened, with pictures', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('open').click();
  await page.waitForFunction(
    () => {
      const images = [...document.querySelectorAll('.open-list .thumb img')];
      return images.length >= 8 && images.every((i) => i.complete && i.naturalWidth === 240);
    },
    undefined,
    long,
  );
  assert.ok(await page.locator('.open-list .item', { hasText: 'finger.toml' }).isVisible());
  await page.keyboard.press('Escape');
  assert.deepEqual(wrong, []);
});

/// Of the page's choice of results.
const choose = (page, key) => page.getByTestId('sweep-result').selectOption(key);

test('a sweep of one number gives a curve, of two a map; its values can be used, and it can be cancelled', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('tab-sweep').click();
  assert.ok(await page.getByTestId('find-sweep').isDisabled());
  await page.getByTestId('sweep-0-key').selectOption('material.soft.youngs_modulus');
  for (const [id, value] of [['from', '1'], ['to', '2'], ['count', '3']]) {
    await page.getByTestId(`sweep-0-${id}`).fill(value);
    await page.getByTestId(`sweep-0-${id}`).press('Enter');
  }
  await page.getByTestId('find-sweep').click();
  await page.getByTestId('sweep-found').waitFor(long);
  await choose(page, 'flexor_tension_N');
  assert.equal(await page.locator('.response-dot').count(), 3);
  await page.locator('details summary', { hasText: 'Table' }).click();
  const cell = async (k) => Number(await page.locator('.sweep-table tbody tr').nth(k).locator('td').nth(1).textContent());
  const [soft, stiff] = [await cell(0), await cell(2)];
  assert.ok(Math.abs(stiff / soft - 2) < 0.01, `${soft} N and ${stiff} N`);
  const [csv] = await Promise.all([page.waitForEvent('download'), page.getByTestId('sweep-csv').click()]);
  assert.match(readFileSync(await csv.path(), 'utf8'), /^material\.soft\.youngs_modulus_MPa,flexor_tension_N,/);
  const before = await readRobot(page);
  await page.getByTestId('sweep-run-2').click();
  await rebuilt(page, () => page.getByTestId('sweep-use').click());
  assert.match(await readRobot(page), /youngs_modulus = "2 MPa"/);
  // A second parameter: a map, a field for every combination.
  await page.getByTestId('sweep-second').click();
  await page.getByTestId('sweep-1-key').selectOption('cable.flexor.target.shortening');
  await page.getByTestId('sweep-1-count').fill('2');
  await page.getByTestId('sweep-1-count').press('Enter');
  await page.getByTestId('find-sweep').click();
  await page.waitForFunction(() => document.querySelectorAll('.heat').length === 6, undefined, long);
  await page.getByTestId('sweep-overlay').click();
  await page.getByTestId('tab-plots').click();
  await page.getByTestId('run-≈ sweep 1').waitFor(); // the robot has linear elements
  // One that takes long is cancelled, and leaves what was found before.
  await page.getByTestId('tab-sweep').click();
  await page.getByTestId('sweep-0-count').fill('60');
  await page.getByTestId('sweep-0-count').press('Enter');
  await page.getByTestId('find-sweep').click();
  await page.getByTestId('cancel-sweep').click();
  await page.getByTestId('find-sweep').waitFor(long);
  assert.equal(await page.locator('.heat').count(), 6);
  await page.getByTestId('tab-build').click();
  await rebuilt(page, () => page.getByTestId('build-undo').click());
  assert.equal(await readRobot(page), before);
  assert.deepEqual(wrong, []);
});

test('a workspace is computed within ranges, and drawn', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('tab-workspace').click();
  await page.getByTestId('workspace-side').fill('4');
  await page.getByTestId('workspace-side').press('Enter');
  assert.match(await page.getByTestId('workspace-count').textContent(), /^4 samples will be solved/);
  await page.getByTestId('find-workspace').click();
  await page.getByTestId('workspace-found').waitFor(long);
  assert.match(await page.getByTestId('workspace-found').textContent(), /Equilibrium found at [34] of 4 samples/);
  assert.match(await page.getByTestId('reach-tip').textContent(), /\d to 40\.0/);
  const [csv] = await Promise.all([page.waitForEvent('download'), page.getByTestId('workspace-csv').click()]);
  assert.match(readFileSync(await csv.path(), 'utf8'), /tip_x_mm/);
  assert.deepEqual(wrong, []);
});

test('the whole program runs in the background, and can be played, paused and moved through', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('motion-run').click();
  await page.getByTestId('motion-play').waitFor(long);
  await page.waitForFunction(() => document.querySelector('[data-testid=motion-time]').textContent === '100 %', undefined, long);
  const shortening = () => page.evaluate(() => 1 - window.pliant.shown().head.cables[0].ratio);
  assert.ok((await shortening()) > 0.02);
  const slider = page.getByTestId('motion-at');
  await slider.focus();
  await slider.press('Home');
  await page.waitForFunction(() => window.pliant.shown().head.time === 0);
  assert.ok(Math.abs(await shortening()) < 1e-9);
  assert.equal(await page.getByTestId('motion-play').getAttribute('aria-label'), 'Play the motion');
  await page.getByTestId('motion-leave').click();
  await page.getByTestId('replay').waitFor();
  assert.deepEqual(wrong, []);
});

test('two robots are shown side by side, and the same inputs move both', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('rest').click();
  await page.getByTestId('compare').click();
  await page.locator('.compare-list .item', { hasText: 'This robot, as it is now' }).click();
  await page.waitForSelector('[data-testid=beside][data-state=arrived]', long);
  await page.getByTestId('tab-file').click();
  await page.getByTestId('modulus-soft').fill('2');
  await rebuilt(page, () => page.getByTestId('modulus-soft').press('Enter'));
  await page.getByTestId('tab-move').click();
  await page.getByTestId('number-flexor').fill('0.8');
  await page.getByTestId('number-flexor').press('Enter');
  // Twice as stiff takes twice the tension for the same shortening.
  await page.waitForFunction(
    () => {
      const cells = [...document.querySelectorAll('[data-testid=compared-flexor_tension_N] td')].map((c) => Number(c.textContent.replace('≈', '')));
      return cells[1] > 0 && Math.abs(cells[0] / cells[1] - 2) < 0.02;
    },
    undefined,
    long,
  );
  // Colours of both have one range, which follows both.
  await page.getByTestId('field').selectOption('von_mises');
  await page.waitForFunction(() => document.querySelectorAll('.field-legend .ticks *').length > 1, undefined, long);
  await page.getByTestId('number-flexor').fill('0.7');
  await page.getByTestId('number-flexor').press('Enter');
  await page.waitForSelector('[data-testid=beside][data-state=arrived]', long);
  await settled(page);
  await page.getByTestId('field').selectOption('material');
  const widths = await page.evaluate(() => [...document.querySelectorAll('.views canvas')].map((c) => c.clientWidth));
  assert.ok(widths.length === 2 && Math.abs(widths[0] - widths[1]) < 3, `${widths}`);
  await page.getByTestId('compare-leave').click();
  await page.getByTestId('beside').waitFor({ state: 'detached' });
  await page.getByTestId('tab-build').click();
  await rebuilt(page, () => page.getByTestId('build-undo').click());
  assert.deepEqual(wrong, []);
});

test('a film can be saved as GIF', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  for (const value of ['0.3', '0.6', '0.9']) {
    const at = await page.evaluate(() => window.pliant.frame.value.head.tag);
    await page.getByTestId('number-flexor').fill(value);
    await page.getByTestId('number-flexor').press('Enter');
    await page.waitForFunction((t) => window.pliant.frame.value?.head.tag > t && window.pliant.frame.value?.head.arrived, at, long);
  }
  const [download] = await Promise.all([
    page.waitForEvent('download', long),
    (async () => {
      await page.getByRole('button', { name: 'Export' }).click();
      await page.locator('.popover .item', { hasText: 'GIF' }).click();
    })(),
  ]);
  const bytes = readFileSync(await download.path());
  assert.equal(bytes.toString('latin1', 0, 6), 'GIF89a');
  assert.equal(bytes.readUInt16LE(6), 640);
  // The browser can show it, and it moves.
  const seen = await page.evaluate(async (data) => {
    const decoder = 'ImageDecoder' in window ? new window.ImageDecoder({ type: 'image/gif', data: Uint8Array.from(atob(data), (c) => c.charCodeAt(0)) }) : null;
    if (!decoder) return null;
    await decoder.tracks.ready;
    await decoder.completed;
    const count = decoder.tracks.selectedTrack.frameCount;
    const pixels = async (k) => {
      const { image } = await decoder.decode({ frameIndex: k });
      const c = new OffscreenCanvas(image.displayWidth, image.displayHeight).getContext('2d');
      c.drawImage(image, 0, 0);
      return c.getImageData(0, 0, image.displayWidth, image.displayHeight).data;
    };
    const [a, b] = [await pixels(0), await pixels(count - 1)];
    let differ = 0;
    for (let i = 0; i < a.length; i += 4) if (Math.abs(a[i] - b[i]) > 30) ++differ;
    return { count, differ };
  }, bytes.toString('base64'));
  if (seen) assert.ok(seen.count >= 3 && seen.differ > 100, JSON.stringify(seen));
  assert.deepEqual(wrong, []);
});
