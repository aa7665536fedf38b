// A studio and a browser for the tests.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createRequire } from 'node:module';

const require = createRequire(join(process.env.PLIANT_WEB ?? new URL('..', import.meta.url).pathname, 'package.json'));
const { chromium } = require('playwright-core');

export const program = process.env.PLIANT_PROGRAM ?? 'build/release/apps/pliant/pliant';

/// A studio on a free port, in a folder of its own.
export async function startStudio(args = [], cwd = undefined) {
  const folder = cwd ?? mkdtempSync(join(tmpdir(), 'pliant_web_'));
  const child = spawn(program, ['studio', '--port', '0', '-q', ...args], { cwd: folder, stdio: ['ignore', 'pipe', 'inherit'] });
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
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-dev-shm-usage'],
  });
}

/// A page that looks at the studio; what it should not do (errors, foreign addresses) is collected in `wrong`.
/// It is closed at the end of test `t`. Playwright's own waiting evaluates texts, which the page's policy forbids: that
/// policy is tested in wire_test.mjs.
export async function openPage(browser, address, t, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1100, height: 720 }, bypassCSP: true, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(30000);
  const wrong = [];
  page.on('pageerror', (error) => wrong.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && wrong.push(message.text()));
  page.on('request', (request) => {
    const url = request.url();
    if (!url.startsWith(new URL(address).origin) && !url.startsWith('blob:') && !url.startsWith('data:')) wrong.push(`asked for ${url}`);
  });
  t?.after(() => leave({ page, context }));
  await page.goto(address);
  return { page, context, wrong };
}

/// Closes a page as a person does: the helm is free at once.
async function leave({ page, context }) {
  await page.evaluate(() => window.pliant.send({ type: 'steer', action: 'leave' })).catch(() => {});
  await page.waitForTimeout(100);
  await context.close();
}

/// The robot is there and at equilibrium.
export async function settled(page) {
  await page.waitForSelector('[data-testid=status][data-state=arrived]');
}
