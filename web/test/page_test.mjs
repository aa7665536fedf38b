// The real page on the real program, as people use it.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, program, says, settled, startBrowser, startStudio, unzipped, readRobot, redrawn, typeRobot } from './studio.mjs';

const robot = new URL('../../examples/tutorial/finger.toml', import.meta.url).pathname;
let folder;
let studio;
let browser;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_page_'));
  cpSync(robot, join(folder, 'finger.toml'));
  studio = await startStudio(['finger.toml'], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  assert.equal(await studio?.stop(), 0);
  rmSync(folder, { recursive: true, force: true });
});

/// Where a marker is, mm, as the page shows it.
async function marker(page, name) {
  const cells = await page.getByTestId(`marker-${name}`).locator('td').allTextContents();
  return cells.slice(0, 3).map(Number);
}

/// Waits until the page shows the answer to its last input.
async function answered(page, before) {
  await page.waitForFunction((t) => window.pliant.frame.value?.head.tag > t, before);
  await settled(page);
}
const tag = (page) => page.evaluate(() => window.pliant.frame.value.head.tag);

/// The same target through the command line.
function simulated(ratio) {
  const text = execFileSync(program, ['simulate', robot, '--json', '--set', `cable.flexor.target.length_ratio=${ratio}`]);
  return JSON.parse(text).steps.at(-1).markers.tip;
}

const near = (a, b, within, what) => a.forEach((x, k) => assert.ok(Math.abs(x - b[k]) < within, `${what}: ${a} is not ${b}`));

test('a dragged slider moves the tip to where pliant simulate puts it', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  assert.match(await page.getByTestId('hint').textContent(), /1 of 3/);
  const slider = page.locator('#actuator-0');
  const box = await slider.boundingBox();
  const started = await tag(page);
  await page.mouse.move(box.x + box.width - 9, box.y + box.height / 2);
  await page.mouse.down();
  for (let k = 1; k <= 8; ++k) await page.mouse.move(box.x + box.width - 9 - (k * box.width) / 36, box.y + box.height / 2);
  await page.mouse.up();
  await answered(page, started);
  const ratio = Number(await page.getByTestId('number-flexor').inputValue());
  assert.ok(ratio < 0.95 && ratio > 0.7, `the slider is at ${ratio}`);
  await page.waitForTimeout(200);
  near(await marker(page, 'tip'), simulated(ratio), 0.05, 'tip');
  const keyed = await tag(page);
  await slider.focus();
  for (let k = 0; k < 20; ++k) await page.keyboard.press('ArrowRight');
  await answered(page, keyed);
  assert.ok(Number(await page.getByTestId('number-flexor').inputValue()) > ratio);
  assert.deepEqual(wrong, []);
});

test('the robot is shown before the page runs, in Simulate only, and gives way to the 3D view', async (t) => {
  const picture = '.first-picture img';
  for (const [hash, visible] of [['', true], ['#simulate', true], ['#make', false], ['#print', false]]) {
    const context = await browser.newContext({ bypassCSP: true });
    t.after(() => context.close());
    const page = await context.newPage();
    await page.route('**/*.js', (route) => route.abort());
    await page.goto(studio.address + hash);
    await page.waitForFunction((of) => document.querySelector(of).naturalWidth > 100, picture);
    assert.equal(await page.locator(picture).isVisible(), visible, hash);
    if (!visible) continue;
    const [drawn, stage] = await Promise.all([picture, '.stage'].map((of) => page.locator(of).boundingBox()));
    assert.ok(drawn.width > 0.9 * stage.width && drawn.x >= stage.x && drawn.y >= stage.y, JSON.stringify([drawn, stage]));
  }
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  assert.equal(await page.locator(picture).count(), 0);
  await page.getByTestId('section-make').click();
  await page.getByTestId('section-simulate').click();
  assert.equal(await page.locator(picture).count(), 0);
  assert.deepEqual(wrong, []);
});

test('the program plays to its end, and a body can be pulled with the pointer', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('rest').click();
  await page.getByTestId('play').click();
  await page.waitForFunction(() => window.pliant.frame.value?.head.time > 0.999 && !window.pliant.frame.value?.head.playing);
  await settled(page);
  near(await marker(page, 'tip'), simulated(0.85), 0.05, 'tip');
  const before = await marker(page, 'tip');
  const view = await page.getByTestId('view').boundingBox();
  const tip = await page.locator('.labels span', { hasText: 'tip' }).boundingBox();
  const started = await tag(page);
  const [x, y] = [tip.x - 32, tip.y + 16]; // beside the marker's dot
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let k = 1; k <= 6; ++k) await page.mouse.move(x, y - 10 * k);
  await page.waitForFunction((t) => window.pliant.frame.value?.head.tag > t && window.pliant.frame.value?.head.pull, started);
  await settled(page);
  const pulled = await marker(page, 'tip');
  assert.ok(Math.hypot(...pulled.map((x, k) => x - before[k])) > 1, `${pulled} was ${before} in a view of ${view.width}`);
  await page.mouse.up();
  await page.waitForFunction(() => !window.pliant.frame.value?.head.pull && window.pliant.frame.value?.head.arrived);
  near(await marker(page, 'tip'), before, 0.1, 'let go');
  assert.deepEqual(wrong, []);
});

/// The marker in hand has come far from `before`, and no input is on its way any more.
async function ledThere(page, before) {
  const sequence = () => page.evaluate(() => window.pliant.frame.value.head.sequence);
  await page.waitForFunction((from) => {
    const cells = [...document.querySelectorAll('[data-testid=marker-tip] td')].slice(0, 3);
    const away = Math.hypot(...cells.map((cell, k) => Number(cell.textContent) - from[k]));
    return window.pliant.frame.value.head.lead?.settled && away > 3;
  }, before);
  for (let last = -1; last !== (await sequence()); await page.waitForTimeout(1500)) last = await sequence();
}

test('a dragged marker moves its cable, stays where it is released, and shows its limits', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('rest').click();
  await page.waitForFunction(() => window.pliant.frame.value?.head.cables[0].ratio > 0.9999);
  await settled(page);
  await redrawn(page);
  const dot = async () => {
    const label = await page.locator('.labels span', { hasText: 'tip' }).boundingBox();
    return [label.x - 9, label.y + 10];
  };
  const before = await marker(page, 'tip');
  const [x, y] = await dot();
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let k = 1; k <= 8; ++k) await page.mouse.move(x - k, y - 4 * k);
  await ledThere(page, before);
  const led = await page.evaluate(() => window.pliant.frame.value.head);
  const moved = await marker(page, 'tip');
  assert.ok(Math.hypot(...moved.map((v, k) => v - before[k])) > 3, `${moved} was ${before}`);
  const value = Number(await page.getByTestId('number-flexor').inputValue());
  assert.ok(value < 0.99, `the slider is at ${value}`);
  await page.mouse.move(x - 10, y - 300);
  await page.waitForFunction((near) => window.pliant.frame.value?.head.lead?.settled && window.pliant.frame.value?.head.lead.error_mm > near + 5, led.lead.error_mm);
  await says(page.getByTestId('lead-limits'), /nearest point/);
  await page.mouse.up();
  await page.waitForFunction(() => !window.pliant.frame.value?.head.lead);
  await settled(page);
  const value2 = Number(await page.getByTestId('number-flexor').inputValue());
  near(await marker(page, 'tip'), simulated(value2), 0.1, 'let go, where the slider is');
  assert.deepEqual(wrong, []);
});

test('a goal is solved without editing the file: reached, or the nearest point; moved to, and saved as a program', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('rest').click();
  await page.waitForFunction(() => window.pliant.frame.value?.head.cables[0].ratio > 0.9999);
  // A place that the tip has with a cable of 0.88 is one that it can get to.
  const want = simulated(0.88);
  await page.getByTestId('tab-goal').click();
  await page.getByTestId('goal-here').click();
  await page.getByTestId('goal-add').click();
  const set = async (id, value) => {
    await page.getByTestId(id).fill(String(value));
    await page.getByTestId(id).press('Enter');
  };
  for (const [k, axis] of ['x', 'y', 'z'].entries()) await set(`goal-0-${axis}`, want[k].toFixed(2));
  await set('goal-1-z', 300);
  await page.getByTestId('find-goal').click();
  await page.waitForSelector('[data-testid=waypoint-2]', { timeout: 60_000 });
  assert.equal(await page.getByTestId('waypoint-1').getAttribute('data-reached'), 'true');
  assert.equal(await page.getByTestId('waypoint-2').getAttribute('data-reached'), 'false');
  assert.match(await page.getByTestId('waypoint-2').textContent(), /nearest point.*flexor/);
  const started = await tag(page);
  await page.getByTestId('go-1').click();
  await answered(page, started);
  await page.getByTestId('tab-move').click();
  assert.ok(Math.abs(Number(await page.getByTestId('number-flexor').inputValue()) - 0.88) < 2e-3);
  near(await marker(page, 'tip'), want, 0.12, 'tip');
  await page.getByTestId('tab-goal').click();
  await page.getByTestId('goal-program').click();
  await page.getByTestId('tab-file').click();
  await page.waitForFunction(() => window.pliant.robotText.value.includes('[[program.key]]'));
  const written = await readRobot(page);
  assert.match(written, /time = "1 s"\n"flexor" = 0\.[89]/);
  assert.match(written, /duration = "2 s"/);
  // The program passes the position that was reached.
  writeFileSync(join(folder, 'reached.toml'), written);
  const { steps } = JSON.parse(execFileSync(program, ['simulate', join(folder, 'reached.toml'), '--json']));
  near(steps.find((s) => Math.abs(s.time - 1) < 1e-9).markers.tip, want, 0.12, 'tip in the program');
  await page.getByRole('button', { name: 'Undo' }).click();
  await page.waitForFunction(() => !window.pliant.robotText.value.includes('[[program.key]]'));
  await page.getByTestId('tab-goal').click();
  await set('goal-low-flexor', 2);
  await page.getByTestId('find-goal').click();
  assert.match(await page.getByTestId('refused-goal').textContent(), /flexor: the range from 2 to 1 is empty/);
  assert.equal(await page.getByTestId('goal-found').count(), 0, 'what was found before is no answer to this');
  assert.equal(await page.getByTestId('goal-program').count(), 0);
  assert.deepEqual(wrong.filter((w) => !/422/.test(w)), []);
});

test('unknown numbers are identified from a table of measurements and written into the file', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  const rows = [0.85, 0.9, 0.95].map((ratio) => {
    const text = execFileSync(program, ['simulate', robot, '--json', '--set', 'material.soft.youngs_modulus=9MPa', '--set', `cable.flexor.target.length_ratio=${ratio}`]);
    const step = JSON.parse(text).steps.at(-1);
    return `${((1 - ratio) / 0.15).toFixed(6)},${step.markers.tip[2]}`;
  });
  await page.getByTestId('tab-identify').click();
  assert.ok(await page.getByTestId('find-identify').isDisabled());
  await page.getByTestId('unknown-material.soft.youngs_modulus').check();
  await page.getByTestId('bounds-material.soft.youngs_modulus').fill('1 MPa..40 MPa');
  await page.getByTestId('measured').setInputFiles({ name: 'hole.csv', mimeType: 'text/csv', buffer: Buffer.from('time,nothing\n1,2\n') });
  await page.getByTestId('find-identify').click();
  assert.match(await page.getByTestId('refused-identify').textContent(), /hole\.csv:1: the robot has nothing that column "nothing" could be/);
  const heldOut = page.getByTestId('judge').locator('option').first();
  assert.equal(await heldOut.textContent(), 'none');
  await page.getByTestId('measured').setInputFiles({ name: 'use.csv', mimeType: 'text/csv', buffer: Buffer.from('time,use,tip_z_mm\n1,fit,2\n2,judge,3\n') });
  await page.waitForFunction(() => document.querySelector('[data-testid=judge] option').textContent === 'as in the file (1 row)');
  await page.getByTestId('measured').setInputFiles({ name: 'tip.csv', mimeType: 'text/csv', buffer: Buffer.from(`time,tip_z_mm\n${rows.join('\n')}\n`) });
  await page.getByTestId('find-identify').click();
  await page.waitForSelector('[data-testid="found-material.soft.youngs_modulus"]', { timeout: 60_000 });
  assert.match(await page.getByTestId('found-material.soft.youngs_modulus').textContent(), /12 MPa(9|8\.99\d*|9\.00\d*) MPa/);
  await page.waitForFunction(() => document.querySelector('.found-plot')?.naturalWidth > 100);
  await page.getByTestId('identify-use').click();
  await page.getByTestId('tab-file').click();
  await page.waitForFunction(() => Math.abs(Number(document.querySelector('[data-testid=modulus-soft]')?.value) - 9) < 0.02);
  await page.getByRole('button', { name: 'Undo' }).click();
  await page.waitForFunction(() => document.querySelector('[data-testid=modulus-soft]')?.value === '12');
  assert.deepEqual(wrong.filter((w) => !/422/.test(w)), []);
});

test('a mistake in the robot file is shown at its line', async (t) => {
  const { page } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('tab-file').click();
  await page.waitForFunction(() => window.pliant.robotText.value.includes('youngs_modulus'));
  const good = await readRobot(page);
  const line = good.split('\n').findIndex((l) => l.includes('youngs_modulus')) + 1;
  await typeRobot(page, good.replace('youngs_modulus', 'young_modulus'));
  await page.getByTestId('apply').click();
  await page.waitForSelector('[data-testid=problems]');
  assert.match(await page.getByTestId('problems').textContent(), new RegExp(`line ${line} .*young_modulus`));
  // At the line itself: the mark in the margin is on its height.
  // The editor draws its marks anew whenever the text has been checked: the two are looked at together.
  await page.waitForFunction(() => {
    const middle = (of) => of && of.getBoundingClientRect().top + of.getBoundingClientRect().height / 2;
    const line = [...document.querySelectorAll('.cm-line')].find((l) => l.textContent.includes('young_modulus'));
    const marks = [...document.querySelectorAll('.cm-lint-marker-error')];
    return line && marks.some((m) => Math.abs(middle(m) - middle(line)) < 9);
  });
  await typeRobot(page, good);
  await page.getByTestId('robot-file').press('Control+Enter');
  await page.waitForSelector('[data-testid=problems]', { state: 'detached' });
  await settled(page);
  assert.equal(readFileSync(join(folder, 'finger.toml'), 'utf8'), good, 'nothing is written before it is saved');
});

test('text that is typed before the studio has answered stays', async (t) => {
  const { page } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('tab-file').click();
  await page.waitForFunction(() => window.pliant.robotText.value.includes('youngs_modulus'));
  const good = await readRobot(page);
  const answers = [];
  await page.route('**/api/robot', (route) => (route.request().method() === 'GET' ? answers.push(route) : route.continue()));
  await typeRobot(page, good.replace('youngs_modulus', 'young_modulus'));
  await page.getByTestId('apply').click();
  await page.waitForSelector('[data-testid=problems]');
  await typeRobot(page, good); // as it was before Apply
  while (answers.length === 0) await page.waitForTimeout(20);
  await page.unroute('**/api/robot');
  for (const route of answers) await route.continue();
  await page.waitForFunction((t) => window.pliant.robotText.value === t, good);
  await page.getByTestId('apply').click(); // it is a change: the studio has the other text
  await page.waitForSelector('[data-testid=problems]', { state: 'detached' });
  await settled(page);
  assert.equal(await readRobot(page), good);
});

test('a robot is built by clicks, sliders and the library; the rest of the text stays, and every change can be undone', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('rest').click();
  await page.waitForFunction(() => window.pliant.frame.value?.head.cables[0].ratio > 0.9999);
  const before = await readRobot(page);
  const revision = () => page.evaluate(() => window.pliant.scene.value.head.revision);
  const rebuilt = async (act) => {
    const last = await revision();
    await act();
    await page.waitForFunction((r) => window.pliant.scene.value?.head.revision > r, last, { timeout: 60_000 });
    await settled(page);
  };
  await page.getByTestId('tab-build').click();
  // A marker where the robot is clicked, in the middle between its ends.
  await page.getByTestId('view').focus();
  await page.keyboard.press('1');
  await page.waitForTimeout(300);
  await page.getByTestId('place-marker').click();
  const view = await page.getByTestId('view').boundingBox();
  await rebuilt(() => page.mouse.click(view.x + view.width / 2 - 20, view.y + view.height / 2 + 14));
  const placed = await page.evaluate(() => window.pliant.scene.value.head.markers.find((m) => m.name === 'marker 1').rest);
  assert.ok(Math.abs(placed[0] - 37) < 6 && Math.abs(placed[1]) < 0.3, `${placed}`);
  assert.match(await readRobot(page), /\[\[marker\]\]\nname = "marker 1"\npoint = \[/);
  // A parameter by its slider.
  await page.getByTestId('tab-build').click();
  const notches = page.getByTestId('parameter-notches');
  await rebuilt(async () => {
    await notches.focus();
    await notches.press('ArrowLeft');
  });
  assert.match(await readRobot(page), /\nnotches = 3\n/);
  // A material of the library.
  await rebuilt(() => page.getByTestId('material-of-tip').selectOption('dragon-skin-30'));
  const materials = await page.evaluate(() => window.pliant.scene.value.head.materials.map((m) => m.name));
  assert.ok(materials.includes('dragon-skin-30'), `${materials}`);
  // Nothing else has changed: comments are where they were.
  const comments = (s) => s.split('\n').filter((l) => l.includes('#')).map((l) => l.slice(l.indexOf('#')));
  assert.deepEqual(comments(await readRobot(page)), comments(before));
  for (let k = 0; k < 3; ++k) await rebuilt(() => page.getByTestId('build-undo').click());
  assert.equal(await readRobot(page), before);
  assert.deepEqual(wrong, []);
});

test('keys are completed, and text is checked before it is applied', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('tab-file').click();
  await page.waitForFunction(() => window.pliant.robotText.value.includes('youngs_modulus'));
  const good = await readRobot(page);
  await typeRobot(page, `${good}[mesh_]\n`);
  await page.getByTestId('problems').filter({ hasText: 'mesh_' }).waitFor();
  await typeRobot(page, good);
  await page.getByTestId('problems').waitFor({ state: 'detached' });
  await page.keyboard.press('Control+End');
  await page.keyboard.type('dura');
  await page.locator('.cm-tooltip-autocomplete li', { hasText: 'duration' }).click();
  await page.keyboard.type('"2 s"');
  assert.ok((await readRobot(page)).endsWith('\nduration = "2 s"'));
  await page.waitForFunction(() => document.querySelector('.cm-line span') !== null);
  const colours = await page.locator('.cm-line', { hasText: 'name = "finger"' }).first().locator('span').evaluateAll((all) => new Set(all.map((s) => getComputedStyle(s).color)).size);
  assert.ok(colours >= 2, 'keys and texts are told apart');
  await page.getByTestId('revert').click();
  assert.equal(await readRobot(page), good);
  assert.deepEqual(wrong, []);
});

test('a link restores state and view; a film and a picture for print can be saved', async (t) => {
  const { page, context, wrong } = await openPage(browser, studio.address, t, { permissions: ['clipboard-read', 'clipboard-write'] });
  await settled(page);
  const started = await tag(page);
  await page.getByTestId('number-flexor').fill('0.91');
  await page.getByTestId('number-flexor').press('Enter');
  await answered(page, started);
  await page.getByTestId('field').selectOption('displacement');
  await page.getByTestId('view').focus();
  await page.keyboard.press('5');
  const item = async (name) => {
    await page.getByRole('button', { name: 'Export' }).click();
    await page.locator('.popover .item', { hasText: name }).click();
  };
  await item('Link to this state');
  await page.getByTestId('notice').waitFor();
  const link = await page.evaluate(() => navigator.clipboard.readText());
  assert.ok(link.startsWith(`${studio.address}#simulate?`), link);
  const picture = (p) =>
    p.evaluate(() => {
      const small = Object.assign(document.createElement('canvas'), { width: 60, height: 40 }).getContext('2d');
      small.drawImage(document.querySelector('[data-testid=view]'), 0, 0, 60, 40);
      return Array.from(small.getImageData(0, 0, 60, 40).data);
    });
  const differ = (a, b) => a.filter((v, k) => Math.abs(v - b[k]) > 24).length;
  await page.waitForTimeout(400);
  const before = await picture(page);
  const there = await marker(page, 'tip');
  await page.getByTestId('rest').click();
  await page.getByTestId('field').selectOption('material');
  await page.keyboard.press('1');
  await page.waitForFunction(() => window.pliant.frame.value?.head.cables[0].ratio > 0.9999);
  await page.waitForTimeout(400);
  const elsewhere = differ(await picture(page), before);
  assert.ok(elsewhere > 100, `${elsewhere}`);
  await page.evaluate(() => window.pliant.send({ type: 'steer', action: 'leave' }));
  const second = await context.newPage();
  await second.goto(link);
  await second.waitForFunction(() => Math.abs(window.pliant.frame.value?.head.cables[0].ratio - 0.91) < 1e-6, undefined, { timeout: 60_000 });
  await settled(second);
  near(await marker(second, 'tip'), there, 0.05, 'tip');
  assert.equal(await second.getByTestId('field').inputValue(), 'displacement');
  await second.waitForTimeout(500);
  const differs = differ(await picture(second), before);
  assert.ok(differs < 0.1 * elsewhere, `from where it was seen: ${differs} differ, and from elsewhere ${elsewhere}`);
  const download = async (p, name) => {
    const [file] = await Promise.all([
      p.waitForEvent('download'),
      (async () => {
        await p.getByRole('button', { name: 'Export' }).click();
        await p.locator('.popover .item', { hasText: name }).click();
      })(),
    ]);
    return readFileSync(await file.path());
  };
  const webm = await download(second, 'WebM');
  assert.equal(webm.readUInt32BE(0), 0x1a45dfa3, 'EBML');
  // The browser plays it to its end.
  const played = await second.evaluate(async (data) => {
    const video = Object.assign(document.createElement('video'), { muted: true, src: URL.createObjectURL(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: 'video/webm' })) });
    await new Promise((ready, failed) => ((video.onloadedmetadata = ready), (video.onerror = failed)));
    const { duration, videoWidth } = video;
    await video.play();
    await new Promise((ended) => (video.onended = ended));
    return { duration, videoWidth, at: video.currentTime, shown: video.getVideoPlaybackQuality().totalVideoFrames };
  }, webm.toString('base64'));
  assert.ok(played.duration >= 1.2 && Math.abs(played.at - played.duration) < 0.1 && played.videoWidth % 2 === 0, JSON.stringify(played));
  assert.ok(played.shown >= 3, JSON.stringify(played));
  const png = await download(second, 'Picture for print');
  assert.ok(Math.abs(png.readUInt32BE(16) - 3840) <= 2, `${png.readUInt32BE(16)} pixels wide`);
  await second.close();
  assert.deepEqual(wrong, []);
});

test('every template opens as a robot that has no file yet', async (t) => {
  const own = await startStudio(['finger.toml'], folder);
  t.after(() => own.stop());
  const { page, wrong } = await openPage(browser, own.address, t);
  await settled(page);
  for (const [label, name] of [['Finger with a cable', 'finger'], ['Bending chamber', 'bender'], ['Beam under its weight', 'beam']]) {
    const revision = await page.evaluate(() => window.pliant.scene.value.head.revision);
    await page.getByTestId('open').click();
    await page.locator('.open-list .item', { hasText: label }).click();
    const discard = page.getByTestId('discard');
    if (await discard.waitFor({ timeout: 1000 }).then(() => true, () => false)) await discard.click();
    await page.waitForFunction((r) => window.pliant.scene.value?.head.revision > r, revision, { timeout: 60_000 });
    await settled(page);
    assert.equal(await page.evaluate(() => window.pliant.scene.value.head.robot), name);
    const state = await page.evaluate(() => window.pliant.documentState.value);
    assert.equal(state.name, '');
    assert.equal(state.unsaved, true);
  }
  assert.deepEqual(wrong, []);
});

test('a duplicated tab is a page of its own, and the first keeps control when it is closed', async (t) => {
  const { page, context, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  const key = (p) => p.evaluate(() => sessionStorage.getItem('pliant_page'));
  const first = await key(page);
  // A page that another one opens begins with a copy of its session, as the duplicate of a tab does.
  const [copy] = await Promise.all([context.waitForEvent('page'), page.evaluate(() => void window.open(location.href))]);
  await copy.waitForSelector('[data-testid=helm][data-state=watching]', { timeout: 60_000 });
  assert.notEqual(await key(copy), first);
  assert.equal(await key(page), first);
  await copy.reload();
  await copy.waitForSelector('[data-testid=helm][data-state=watching]', { timeout: 60_000 });
  await copy.close({ runBeforeUnload: true });
  await page.waitForFunction(() => window.pliant.helm.value.pages === 1);
  assert.ok(await page.evaluate(() => window.pliant.helm.value.you));
  await page.reload();
  await page.waitForFunction(() => window.pliant.online.value && window.pliant.helm.value.held);
  assert.equal(await key(page), first, 'a page that is loaded again keeps its key');
  assert.deepEqual(wrong, []);
});

test('several pages watch, one is in control, and control can be handed over', async (t) => {
  const first = await openPage(browser, studio.address, t);
  await settled(first.page);
  const second = await openPage(browser, studio.address, t);
  await settled(second.page);
  await second.page.waitForSelector('[data-testid=helm][data-state=watching]');
  assert.ok(await second.page.locator('#actuator-0').isDisabled());
  const started = await tag(first.page);
  await first.page.getByTestId('number-flexor').fill('0.9');
  await first.page.getByTestId('number-flexor').press('Enter');
  await answered(first.page, started);
  const there = await marker(first.page, 'tip');
  await second.page.waitForFunction((x) => Math.abs(window.pliant.frame.value?.head.markers.at(-1)[0] - x) < 0.01 || window.pliant.frame.value?.head.arrived, there[0]);
  await second.page.waitForTimeout(300);
  near(await marker(second.page, 'tip'), there, 0.02, 'both see the same');
  await second.page.getByTestId('ask').click();
  await first.page.getByRole('button', { name: 'Hand over' }).click();
  await second.page.waitForSelector('[data-testid=helm][data-state=steering]');
  await first.page.waitForSelector('[data-testid=helm][data-state=watching]');
  assert.ok(await second.page.locator('#actuator-0').isEnabled());
  assert.deepEqual([...first.wrong, ...second.wrong], []);
});

test('a new page gets control at once if the page that had it is gone, an older one within ten seconds', async (t) => {
  const other = await startStudio();
  t.after(() => other.stop());
  const first = await openPage(browser, other.address, t);
  await first.page.waitForSelector('[data-testid=helm][data-state=steering]', { state: 'attached' });
  const crash = (page) => page.evaluate(() => { // a browser that crashes says nothing, and does not come back
    WebSocket.prototype.send = () => {};
    window.WebSocket = class { constructor() { throw new Error('crashed'); } };
    window.pliant.dropLine();
  });
  await crash(first.page);
  const second = await openPage(browser, other.address, t);
  await second.page.waitForSelector('[data-testid=helm][data-state=steering]', { state: 'attached', timeout: 4000 });
  const third = await openPage(browser, other.address, t);
  await third.page.waitForSelector('[data-testid=helm][data-state=watching]');
  await crash(second.page);
  await third.page.waitForSelector('[data-testid=helm][data-state=steering]', { state: 'attached', timeout: 13_000 });
  assert.deepEqual(third.wrong, []);
});

test('mesh, rest shape, section, exploded parts, fields and pins are drawn, and every result can be saved', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  const picture = () =>
    page.evaluate(() => {
      const c = document.querySelector('[data-testid=view]');
      const small = Object.assign(document.createElement('canvas'), { width: 120, height: 80 }).getContext('2d');
      small.drawImage(c, 0, 0, 120, 80);
      return Array.from(small.getImageData(0, 0, 120, 80).data);
    });
  let before = await picture();
  const changed = async (what) => {
    await page.waitForTimeout(400);
    const after = await picture();
    const differ = after.filter((v, k) => Math.abs(v - before[k]) > 12).length;
    assert.ok(differ > 20, `${what} changes the picture (${differ})`);
    before = after;
  };
  await page.getByRole('button', { name: 'Mesh' }).click();
  await changed('the mesh');
  await page.getByRole('button', { name: 'Section' }).click();
  await page.getByRole('group', { name: 'Section plane' }).getByRole('button', { name: 'x' }).click();
  await changed('a section');
  await page.getByRole('slider', { name: 'Explode' }).fill('0.8');
  await changed('pulling apart');
  await page.getByRole('slider', { name: 'Explode' }).fill('0');
  await page.getByRole('group', { name: 'Section plane' }).getByRole('button', { name: 'off' }).click();
  await page.getByRole('button', { name: 'Section' }).click();
  await page.getByRole('button', { name: 'Mesh' }).click();
  const started = await tag(page);
  await page.getByTestId('number-flexor').fill('0.88');
  await page.getByTestId('number-flexor').press('Enter');
  await answered(page, started);
  await page.waitForTimeout(400);
  before = await picture();
  await page.getByRole('button', { name: 'Rest shape' }).click();
  await changed('the rest shape');
  for (const field of ['displacement', 'von_mises', 'stretch', 'J', 'energy']) {
    await page.getByTestId('field').selectOption(field);
    await page.waitForFunction(() => document.querySelector('[data-testid=legend] .ticks span').textContent !== '0');
    if (field === 'displacement') await changed('a field');
  }
  await page.getByTestId('pin').click();
  await page.getByTestId('pinned').waitFor();
  const files = await page.evaluate(async () =>
    Promise.all(
      ['steps.csv', 'markers.csv', 'robot.glb', 'robot.vtu'].map(async (name) => {
        const answer = await fetch(`/api/export/${name}`);
        return [answer.status, (await answer.text()).slice(0, 400)];
      }),
    ),
  );
  assert.deepEqual(files.map((f) => f[0]), [200, 200, 200, 200]);
  assert.match(files[0][1], /flexor/);
  assert.match(files[1][1], /tip/);
  assert.match(files[2][1], /^glTF/);
  assert.match(files[3][1], /VTKFile/);
  const [png] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: 'Export' }).click().then(() => page.getByRole('button', { name: 'Image' }).click()),
  ]);
  assert.equal(readFileSync(await png.path()).toString('latin1', 1, 4), 'PNG');
  await page.getByRole('button', { name: 'Export' }).click();
  await page.locator('.popover').waitFor();
  await page.keyboard.press('Escape');
  await page.locator('.popover').waitFor({ state: 'detached' });
  assert.deepEqual(wrong, []);
});

test('the view has standard sides, a ruler, a movable section, and a colour range that can be set', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.evaluate(() => localStorage.setItem('pliant_hints', '9'));
  await page.reload();
  await settled(page);
  await page.getByTestId('rest').click();
  await page.waitForFunction(() => window.pliant.frame.value?.head.cables[0].ratio > 0.9999);
  await page.getByTestId('view-menu').click();
  await page.getByTestId('view-top').click();
  const label = (name) => page.locator('.labels span', { hasText: name }).boundingBox();
  const perMm = async () => {
    const bar = page.getByTestId('scale-bar');
    return (await bar.boundingBox()).width / Number((await bar.textContent()).replace(' mm', ''));
  };
  // From the top x goes to the right and y up; the scale bar says how far it is.
  await page.waitForTimeout(300);
  const [canvas, tip, scale] = [await page.getByTestId('view').boundingBox(), await label('tip'), await perMm()];
  const [x, , ] = await marker(page, 'tip');
  const middle = await page.evaluate(() => {
    const r = window.pliant.scene.value.f32('rest');
    let [low, high] = [Infinity, -Infinity];
    for (let i = 0; i < r.length; i += 3) [low, high] = [Math.min(low, r[i]), Math.max(high, r[i])];
    return (low + high) / 2;
  });
  const expected = canvas.x + canvas.width / 2 + scale * (x - middle);
  assert.ok(Math.abs(tip.x - 9 - expected) < 0.06 * canvas.width, `${tip.x - 9} is not ${expected}`);
  // By key, and by the cube.
  const picture = () => page.evaluate(() => document.querySelector('[data-testid=view]').toDataURL());
  const top = await picture();
  await page.getByTestId('view').focus();
  /// Another picture than `last`, once it does not change any more.
  const turnedFrom = async (last) => {
    for (let before = last, k = 0; k < 100; ++k) {
      await page.waitForTimeout(200);
      const now = await picture();
      if (now === before && now !== last) return now;
      before = now;
    }
    return assert.fail('the view does not turn');
  };
  await page.keyboard.press('1');
  const front = await turnedFrom(top);
  await page.getByTestId('view-cube').locator('button', { hasText: 'Front' }).click();
  await page.waitForTimeout(500);
  assert.ok((await picture()) === front, 'the cube and the key turn to the same side');
  // Two presses are a distance.
  await page.getByTestId('measure-toggle').click();
  const dot = await label('tip');
  const [px, py] = [dot.x - 9, dot.y + 10];
  await page.mouse.click(px, py);
  await page.mouse.click(px - 20 * (await perMm()), py);
  const distance = Number((await page.getByTestId('measured-distance').locator('td').textContent()).replace(' mm', ''));
  assert.ok(Math.abs(distance - 20) < 6, `${distance} mm`);
  await page.mouse.click(px - 30 * (await perMm()), py);
  assert.match(await page.getByTestId('measured-angle').textContent(), /^angle1[5-8]\d\.\d\d°$/);
  await page.getByRole('button', { name: 'Stop measuring' }).click();
  // The section by its handle.
  await page.getByRole('button', { name: 'Section' }).click();
  await page.getByRole('group', { name: 'Section plane' }).getByRole('button', { name: 'x' }).click();
  const handle = page.getByTestId('section-handle');
  await page.waitForTimeout(300);
  const box = await handle.boundingBox();
  await page.mouse.move(box.x + 15, box.y + 15);
  await page.mouse.down();
  await page.mouse.move(box.x + 75, box.y + 15, { steps: 6 });
  await page.mouse.up();
  const dragged = Number(await handle.getAttribute('aria-valuenow'));
  assert.ok(dragged > 52, `at ${dragged} %`);
  await handle.press('PageDown');
  assert.equal(Number(await handle.getAttribute('aria-valuenow')), dragged - 10);
  await page.waitForTimeout(200);
  const moved = await handle.boundingBox();
  assert.ok(moved.x > box.x - 80 && moved.x !== box.x, 'the handle goes along');
  await page.getByRole('group', { name: 'Section plane' }).getByRole('button', { name: 'off' }).click();
  await page.getByRole('button', { name: 'Section' }).click();
  // The legend.
  await page.getByTestId('field').selectOption('displacement');
  await page.getByTestId('legend-button').click();
  await page.getByTestId('range-high').fill('40');
  await page.getByTestId('range-high').press('Enter');
  await page.waitForFunction(() => document.querySelector('[data-testid=legend] .ticks span').textContent === '40');
  await page.getByTestId('colour-map').selectOption('cividis');
  await page.getByTestId('colour-bands').selectOption('5');
  assert.match(await page.locator('.field-legend .bar').getAttribute('style'), /linear-gradient/);
  await page.getByTestId('range-auto').click();
  await page.waitForFunction(() => document.querySelector('[data-testid=legend] .ticks span').textContent !== '40');
  assert.deepEqual(wrong, []);
});

test('a graded body is drawn in the colours of both its materials, and the legend names them', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  assert.equal(await page.evaluate(() => window.pliant.scene.value.has('share')), false);
  const text = readFileSync(robot, 'utf8');
  const place = 'material = "firm"\ngeometry';
  assert.ok(text.includes(place));
  const put = (body) =>
    page.evaluate(async (b) => (await fetch('/api/robot', { method: 'PUT', headers: { 'X-Pliant-Page': window.pliant.page }, body: b })).status, body);
  assert.equal(await put(text.replace(place, 'material = "firm"\nblend = { material = "soft", from = [10, 0, 0], to = [30, 0, 0] }\ngeometry')), 200);
  await page.getByTestId('graded-root').waitFor();
  await says(page.getByTestId('graded-root'), /root: firm to soft/);
  const shares = await page.evaluate(() => {
    const s = window.pliant.scene.value;
    const at = (x) => s.f32('share').filter((_, v) => Math.abs(s.f32('rest')[3 * v] - x) < 0.01);
    return [Math.max(...at(0)), s.f32('share').filter((v) => v > 0.3 && v < 0.7).length, Math.max(...s.f32('share'))];
  });
  assert.equal(shares[0], 0, 'nothing of the other where it is held');
  assert.ok(shares[1] > 0, 'mixed in between');
  assert.equal(shares[2], 1, 'all of the other beyond the end');
  assert.equal(await put(text), 200);
  await page.getByTestId('graded-root').waitFor({ state: 'detached' });
  assert.deepEqual(wrong, []);
});

test('a lost connection is restored, with the page still in control', async (t) => {
  const { page } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.waitForSelector('[data-testid=helm][data-state=steering]', { state: 'attached' });
  const before = await marker(page, 'tip');
  await page.evaluate(() => window.pliant.dropLine());
  await page.waitForSelector('[data-testid=helm][data-state=offline]');
  await page.waitForSelector('[data-testid=helm][data-state=steering]', { state: 'attached' });
  near(await marker(page, 'tip'), before, 0.01, 'tip');
  const started = await tag(page);
  await page.getByTestId('number-flexor').fill('0.95');
  // What is typed stays when the page is told everything again in the middle of it.
  await page.evaluate(() => window.pliant.dropLine());
  await page.waitForSelector('[data-testid=helm][data-state=offline]');
  await page.waitForSelector('[data-testid=helm][data-state=steering]', { state: 'attached' });
  await settled(page);
  assert.equal(await page.getByTestId('number-flexor').inputValue(), '0.95');
  await page.getByTestId('number-flexor').press('Enter');
  await answered(page, started);
  assert.ok(Math.abs((await marker(page, 'tip'))[2] - before[2]) > 0.1);
});

test('the robot is sliced, and its layers and plan are shown', async (t) => {
  const { page, wrong } = await openPage(browser, `${studio.address}#make`, t);
  await page.waitForFunction(() => window.pliant.scene.value !== null);
  await page.getByTestId('slice').click();
  await page.waitForSelector('[data-testid=layer-view]');
  await page.getByTestId('layer').fill('40');
  // Somewhere in the picture the layer is drawn in the colour of a material.
  await page.waitForFunction(() => {
    const canvas = document.querySelector('[data-testid=layer-view]');
    const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    const colours = (window.pliant.job.value?.colours ?? []).map((c) => parseInt(c.slice(1), 16));
    for (let i = 0; i < pixels.length; i += 4)
      for (const c of colours) if (pixels[i] === c >> 16 && pixels[i + 1] === ((c >> 8) & 255) && pixels[i + 2] === (c & 255)) return true;
    return false;
  });
  await page.getByTestId('make-plan').click();
  const plan = await page.getByTestId('plan').textContent();
  const swaps = await page.evaluate(() => window.pliant.job.value.plan.swaps);
  assert.match(plan, new RegExp(`${swaps}swaps, minimum`));
  assert.deepEqual(wrong, []);
});

test('an invalid option is reported at its field; supports, bonds and exposure reach the job', async (t) => {
  const { page, wrong } = await openPage(browser, `${studio.address}#make`, t);
  await page.waitForFunction(() => window.pliant.scene.value !== null);
  await page.getByTestId('option-layer').fill('500');
  await page.getByTestId('make-layers').click();
  await page.getByTestId('out-of-date').waitFor();
  const [chip, layer] = [await page.getByTestId('out-of-date').boundingBox(), await page.locator('.layer-info').boundingBox()];
  assert.ok(chip.x + chip.width < layer.x || chip.y > layer.y + layer.height, JSON.stringify([chip, layer]));
  await page.getByTestId('group-hollow').locator('summary').click();
  await page.getByTestId('option-hollow').fill('-1');
  await says(page.getByTestId('wrong-hollow'), /must be above 0/);
  assert.equal(await page.getByTestId('option-hollow').getAttribute('aria-invalid'), 'true');
  await page.getByTestId('option-hollow').fill('');
  await page.getByTestId('wrong-hollow').waitFor({ state: 'detached' });
  await page.getByTestId('group-support').locator('summary').click();
  await page.getByTestId('option-support').selectOption({ index: 1 });
  await page.getByTestId('option-support-tip').fill('9 apples');
  await page.getByTestId('slice').click();
  await page.getByTestId('wrong-support-tip').waitFor();
  assert.match(await page.getByTestId('wrong-support-tip').textContent(), /apples/);
  await page.getByTestId('option-support-tip').fill('0.6');
  await page.getByTestId('option-lift').fill('3');
  await page.getByTestId('group-exposure').locator('summary').click();
  await page.getByTestId('light-0').fill('3.25');
  await page.getByTestId('group-overlap').locator('summary').click();
  await page.getByTestId('add-bond').click();
  const before = await page.evaluate(() => window.pliant.job.value.revision);
  await page.getByTestId('slice').click();
  await page.waitForFunction((r) => window.pliant.job.value.revision > r, before);
  const file = await (await page.request.get(`${studio.address}api/job/file`)).body();
  const settings = JSON.parse(unzipped(file, 'settings.json'));
  assert.equal(settings.supports.support_tip, '0.6 mm');
  assert.equal(settings.supports.lift, '3 mm');
  assert.equal(settings.overlap.length, 1);
  assert.equal(await page.evaluate(() => window.pliant.job.value.manifest.materials[0].exposure_s), 3.25);
  await page.getByTestId('make-plan').click();
  const gantt = page.getByTestId('gantt');
  const span = async () => {
    const [from, to] = (await gantt.locator('.quiet').textContent()).split(' to ').map((x) => x.split(':').reduce((s, v) => 60 * s + Number(v), 0));
    return to - from;
  };
  const all = await span();
  await page.getByTestId('gantt-nearer').click();
  assert.ok(Math.abs((await span()) - 0.4 * all) < 2, 'the Gantt of the whole job comes nearer');
  assert.deepEqual(wrong, []);
});

test('on a small window the sliders are wide enough, and the legend covers neither robot nor status', async (t) => {
  const { page } = await openPage(browser, studio.address, t, { viewport: { width: 1024, height: 700 } });
  await settled(page);
  await page.getByTestId('field').selectOption('von_mises');
  await page.getByTestId('legend').waitFor();
  for (const id of ['program', 'replay']) assert.ok((await page.getByTestId(id).boundingBox()).width > 150, id);
  const apart = async (other) => {
    const [a, b] = [await page.getByTestId('legend').boundingBox(), await page.getByTestId(other).boundingBox()];
    const over = a.x < b.x + b.width && a.x + a.width > b.x && a.y < b.y + b.height && a.y + a.height > b.y;
    assert.ok(!over, `${other}: ${JSON.stringify([a, b])}`);
  };
  await apart('status');
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(300);
  await apart('status');
  await apart('pin');
  const [legend, view] = [await page.getByTestId('legend').boundingBox(), await page.getByTestId('view').boundingBox()];
  assert.ok(legend.y > view.y + 0.75 * view.height && legend.height < 0.2 * view.height, 'it lies along the lower edge');
  await page.getByTestId('field').selectOption('material');
});

test('on a low or very narrow window nothing that stands over the robot covers the rest', async (t) => {
  const { page } = await openPage(browser, studio.address, t);
  await settled(page);
  for (const [width, height] of [[550, 360], [320, 640]]) {
    await page.setViewportSize({ width, height });
    await redrawn(page);
    const boxes = await page.evaluate(() => ['.lookbar', '.materials-legend', '.stage-right', '.stage-foot'].map((s) => document.querySelector(s).getBoundingClientRect().toJSON()));
    boxes.slice(1).forEach((b, k) => assert.ok(b.top >= boxes[k].bottom, JSON.stringify(boxes)));
  }
});

test('with the colours of a contrast theme, what is chosen has a border, and colours stay', async (t) => {
  const { page } = await openPage(browser, studio.address, t, { forcedColors: 'active' });
  await settled(page);
  const style = (selector, of) => page.evaluate(([s, o]) => getComputedStyle(document.querySelector(s))[o], [selector, of]);
  for (const chosen of ['[data-testid=section-simulate]', '[data-testid=tab-move]']) assert.equal(await style(chosen, 'outlineStyle'), 'solid', chosen);
  assert.notEqual(await style('[data-testid=section-make]', 'outlineStyle'), 'solid');
  const drawn = await page.evaluate(() => window.pliant.scene.value.head.materials[0].colour);
  const [r, g, b] = [1, 3, 5].map((k) => parseInt(drawn.slice(k, k + 2), 16));
  assert.equal(await style('.materials-legend .swatch', 'backgroundColor'), `rgb(${r}, ${g}, ${b})`);
});

test('under Print the bar names the job where it is not of the open robot', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await page.waitForFunction(() => window.pliant.job.value !== null);
  const title = page.getByTestId('open').locator('.title');
  await page.getByTestId('section-print').click();
  assert.equal(await title.textContent(), 'finger');
  await page.evaluate(() => {
    const j = window.pliant.job.value;
    window.pliant.job.value = { ...j, manifest: { ...j.manifest, name: 'halves' } };
  });
  await says(title, /^halves$/);
  await says(page.getByTestId('open').locator('.quiet').first(), 'job; robot: finger (finger.toml)');
  await page.getByTestId('section-simulate').click();
  await says(title, /^finger$/);
  assert.deepEqual(wrong, []);
});

test('at every width the bar says that the robot is not saved', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.evaluate(() => (window.pliant.documentState.value = { ...window.pliant.documentState.value, unsaved: true }));
  for (const width of [390, 900, 1100]) {
    await page.setViewportSize({ width, height: 844 });
    const told = page.getByTestId('open').locator('span:visible', { hasText: 'unsaved' });
    assert.equal(await told.count(), 1, `${width}`);
    const box = await told.boundingBox();
    assert.ok(box.width > 30 && box.x >= 0 && box.x + box.width <= width, `${width}: ${JSON.stringify(box)}`);
  }
  // Beside a long name too: that is what is shortened.
  await page.evaluate(() => {
    const s = window.pliant.scene.value;
    window.pliant.scene.value = { ...s, head: { ...s.head, robot: 'a name that goes on and on, '.repeat(4) } };
  });
  for (const width of [390, 1200]) {
    await page.setViewportSize({ width, height: 844 });
    const [bar, told] = [await page.getByTestId('open').boundingBox(), await page.getByTestId('open').locator('.unsaved').boundingBox()];
    assert.ok(told.width > 30 && told.x + told.width <= bar.x + bar.width, `${width}: ${JSON.stringify([bar, told])}`);
  }
  assert.deepEqual(wrong, []);
});

test('a long name of a robot leaves room for that of its file, and both can be read in full', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.setViewportSize({ width: 1200, height: 844 });
  const long = 'a name that goes on and on, '.repeat(4).trim();
  await page.evaluate((robot) => {
    const s = window.pliant.scene.value;
    window.pliant.scene.value = { ...s, head: { ...s.head, robot } };
    window.pliant.documentState.value = { ...window.pliant.documentState.value, title: 'hand.toml' };
  }, long);
  const bar = page.getByTestId('open');
  await says(bar.locator('.title'), new RegExp(`^${long}$`));
  assert.ok(await bar.locator('.quiet').evaluate((e) => e.clientWidth > 40 && e.scrollWidth <= e.clientWidth), 'the file is named in full');
  assert.ok(await bar.locator('.title').evaluate((e) => e.clientWidth > 100), 'the robot has room too');
  assert.equal(await bar.getAttribute('title'), `${long} · hand.toml`);
  assert.deepEqual(wrong, []);
});

test('on a phone the hints cover none of what they speak of', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t, { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true });
  const hint = page.getByTestId('hint');
  await hint.waitFor();
  for (const other of [page.locator('#actuator-0'), page.getByTestId('view'), page.getByTestId('tab-file')]) {
    const [a, b] = [await hint.boundingBox(), await other.boundingBox()];
    assert.ok(a.y + a.height <= b.y + 1 || b.y + b.height <= a.y + 1, JSON.stringify([a, b]));
  }
  await page.setViewportSize({ width: 1100, height: 844 });
  assert.ok(await hint.isVisible(), 'over the view on a wide screen');
  assert.deepEqual(wrong, []);
});

test('on a phone no button and no field is cut off', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t, { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true });
  await page.waitForFunction(() => window.pliant.job.value !== null);
  for (const section of ['simulate', 'make', 'print']) {
    await page.getByTestId(`section-${section}`).click();
    await page.waitForTimeout(500);
    const cut = await page.evaluate(() =>
      [...document.querySelectorAll('button, input, select, a.button')]
        .filter((e) => e.checkVisibility())
        .map((e) => [e.getBoundingClientRect(), e.dataset.testid ?? e.textContent ?? e.tagName])
        .filter(([b]) => b.width > 0 && (b.left < -1 || b.right > 391))
        .map(([b, name]) => `${name} from ${Math.round(b.left)} to ${Math.round(b.right)}`),
    );
    assert.deepEqual(cut, [], section);
  }
  assert.deepEqual(wrong, []);
});

test('a print on the virtual printer is paused, resumed and cancelled', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await page.waitForFunction(() => window.pliant.job.value !== null);  // the job of the test before
  await page.getByTestId('section-print').click();
  await page.getByTestId('take-speed').selectOption('60');
  await page.getByTestId('take-twin').click();
  await page.waitForSelector('[data-testid=print-state]');
  assert.ok(await page.getByTestId('start').isDisabled(), 'nothing starts unchecked');
  for (const box of await page.locator('.checklist input').all()) await box.check();
  await page.getByTestId('start').click();
  const layer = () => page.getByTestId('print-layer').textContent().then(Number);
  await page.waitForFunction(() => Number(document.querySelector('[data-testid=print-layer]').textContent) >= 2);
  await page.getByTestId('pause').click();
  await page.getByTestId('resume').waitFor();
  assert.equal(await page.getByTestId('print-state').textContent(), 'Paused');
  const paused = await layer();
  await page.waitForTimeout(2000);  // two minutes on the machine's clock
  assert.equal(await layer(), paused, 'nothing is printed in a pause');
  const watcher = await openPage(browser, `${studio.address}#print`, t);
  await watcher.page.waitForSelector('[data-testid=print-state]');
  assert.equal(await watcher.page.getByTestId('print-state').textContent(), 'Paused');
  assert.ok(await watcher.page.getByTestId('resume').isDisabled(), 'who looks on does not steer');
  assert.ok(await watcher.page.getByTestId('emergency').isEnabled(), 'but may stop it');
  await page.getByTestId('resume').click();
  await page.waitForFunction((l) => Number(document.querySelector('[data-testid=print-layer]').textContent) > l, paused);
  await page.getByTestId('cancel').click();
  await page.getByTestId('cancel-sure').click();
  await page.getByTestId('start').waitFor();
  assert.match(await page.getByTestId('log').textContent(), /cancelled/);
  const at = await layer();
  const of = await page.evaluate(() => window.pliant.job.value.manifest.layers.length);
  assert.equal(await page.getByTestId('print-state').textContent(), `Cancelled at layer ${at} of ${of}`);
  assert.equal(await page.getByTestId('cancelled').textContent(), 'Remove the part from the platform.');
  assert.equal(await page.getByTestId('time-left').textContent(), '–');
  assert.deepEqual([...wrong, ...watcher.wrong], []);
});
