// A studio and a browser for the tests.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createRequire } from 'node:module';
import { inflateRawSync } from 'node:zlib';

const require = createRequire(join(process.env.PLIANT_WEB ?? new URL('..', import.meta.url).pathname, 'package.json'));
const { chromium } = require('playwright-core');

export const program = process.env.PLIANT_PROGRAM ?? 'build/release/apps/pliant/pliant';

/// A studio on a free port, or on `port`, in a folder of its own.
export async function startStudio(args = [], cwd = undefined, port = 0) {
  const folder = cwd ?? mkdtempSync(join(tmpdir(), 'pliant_web_'));
  const child = spawn(program, ['studio', '--port', String(port), '-q', ...args], { cwd: folder, stdio: ['ignore', 'pipe', 'inherit'] });
  const address = await new Promise((resolve, reject) => {
    let text = '';
    child.stdout.on('data', (data) => {
      text += data;
      if (text.includes('\n')) resolve(text.trim());
    });
    child.on('exit', (code) => reject(new Error(`the studio ended with ${code}`)));
  });
  return {
    address,
    folder,
    child,
    async stop() {
      const ended = new Promise((resolve) => child.on('exit', (code, signal) => resolve(signal ?? code)));
      child.kill('SIGINT');
      const how = await ended;
      if (!cwd) rmSync(folder, { recursive: true, force: true });
      return how;
    },
  };
}

export async function startBrowser() {
  return chromium.launch({
    executablePath: process.env.PLIANT_CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-gpu-compositing', '--disable-dev-shm-usage'],
  });
}

/// A page that looks at the studio; what it should not do (errors, foreign addresses) is collected in `wrong`.
/// It is closed at the end of test `t`. Playwright's own waiting evaluates texts, which the page's policy forbids: that
/// policy is tested in wire_test.mjs.
export async function openPage(browser, address, t, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1100, height: 720 }, bypassCSP: true, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(90_000); // a browser without a GPU on a busy computer is slow, not wrong
  const wrong = [];
  page.on('pageerror', (error) => wrong.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && wrong.push(`${message.text()} ${message.location().url}`));
  page.on('request', (request) => {
    const url = request.url();
    if (!url.startsWith(new URL(address).origin) && !url.startsWith('blob:') && !url.startsWith('data:')) wrong.push(`asked for ${url}`);
  });
  t?.after(() => leave({ page, context }));
  await page.goto(address);
  return { page, context, wrong };
}

/// Closes a page as a person does: the helm is free at once, unless the studio has ended before.
async function leave({ page, context }) {
  await page.evaluate(() => window.pliant.send({ type: 'steer', action: 'leave' })).catch(() => {});
  await page.waitForFunction(() => !window.pliant.online.value || !window.pliant.helm.value.you, undefined, { timeout: 10_000 }).catch(() => {});
  await context.close().catch(() => {});
}

/// One file of a zip archive, as text.
export function unzipped(bytes, name) {
  for (let at = bytes.length - 22; at >= 0; --at) {
    if (bytes.readUInt32LE(at) !== 0x06054b50) continue;
    let entry = bytes.readUInt32LE(at + 16);
    for (let k = bytes.readUInt16LE(at + 10); k > 0; --k) {
      const [length, extra, comment] = [28, 30, 32].map((o) => bytes.readUInt16LE(entry + o));
      if (bytes.toString('utf8', entry + 46, entry + 46 + length) === name) {
        const local = bytes.readUInt32LE(entry + 42);
        const from = local + 30 + bytes.readUInt16LE(local + 26) + bytes.readUInt16LE(local + 28);
        const packed = bytes.subarray(from, from + bytes.readUInt32LE(entry + 20));
        return (bytes.readUInt16LE(entry + 10) === 8 ? inflateRawSync(packed) : packed).toString();
      }
      entry += 46 + length + extra + comment;
    }
  }
  throw new Error(`${name} is not in the archive`);
}

/// What an element says, as soon as it is drawn: the page draws a little after its values have changed.
export async function says(locator, wanted, patience = 10_000) {
  const fits = (text) => (wanted instanceof RegExp ? wanted.test(text) : text === wanted);
  const end = Date.now() + patience;
  let text = await locator.textContent();
  while (!fits(text) && Date.now() < end) {
    await new Promise((done) => setTimeout(done, 50));
    text = await locator.textContent();
  }
  if (!fits(text)) throw new Error(`"${text}" instead of ${wanted}`);
}

/// The robot is there and at equilibrium. How soon depends on who else uses the machine.
export async function settled(page) {
  await page.waitForSelector('[data-testid=status][data-state=arrived]', { timeout: 90_000 });
}

/// The page has drawn what it knows.
export const redrawn = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))));

/// The speed of the virtual print, also beyond what the page offers.
export const setSpeed = (page, speed) => page.evaluate((s) => fetch('/api/print/speed', { method: 'POST', headers: { 'X-Pliant-Page': window.pliant.page }, body: JSON.stringify({ speed: s }) }), speed);

/// Takes the virtual printer for the job at hand. A print that was interrupted before is discarded, unless `goOn`.
export async function takeTwin(page, speed, { goOn = false } = {}) {
  await page.getByTestId('take-speed').selectOption(speed);
  await page.getByTestId('take-twin').click();
  await page.waitForSelector('[data-testid=print-state]');
  await page.waitForSelector('[data-testid=start], [data-testid=interrupted]');
  if (goOn || !(await page.getByTestId('interrupted').count())) return;
  await page.getByTestId('put-away').click();
  await page.getByTestId('put-away-sure').click();
  await page.getByTestId('start').waitFor();
}

/// Confirms what only people can see, and starts.
export async function startPrint(page) {
  for (const box of await page.locator('.checklist input').all()) await box.check();
  await page.getByTestId('start').click();
}

/// The robot file as it stands in the editor.
export const readRobot = (page) => page.evaluate(() => window.pliant.robotText.value);

/// Writes another text over it, as a person does.
export async function typeRobot(page, text) {
  await page.getByTestId('robot-file').focus();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(text);
  await page.waitForFunction((t) => window.pliant.robotText.value === t, text);
}
