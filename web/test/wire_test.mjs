// The studio's wire without a browser: who is let in, what leads outside, what is too large.
import assert from 'node:assert/strict';
import { request } from 'node:http';
import { connect } from 'node:net';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { startStudio } from './studio.mjs';

let studio;
let origin;
before(async () => {
  studio = await startStudio();
  origin = new URL(studio.address).origin;
});
after(async () => {
  assert.equal(await studio.stop(), 0, 'Ctrl-C ends the studio in good order');
});

/// Status, headers and body of a request with any path and headers, as they are.
function ask(path, { method = 'GET', headers = {}, body } = {}, address = origin) {
  const url = new URL(address);
  return new Promise((resolve, reject) => {
    const r = request({ host: url.hostname, port: url.port, path, method, headers }, (answer) => {
      let text = '';
      answer.on('data', (d) => (text += d));
      answer.on('end', () => resolve({ status: answer.statusCode, headers: answer.headers, text }));
    });
    r.on('error', reject);
    r.end(body);
  });
}

/// The first line that a WebSocket's request is answered with, or '' where the line is cut.
function handshake(headers, path = '/live', address = origin) {
  const url = new URL(address);
  return new Promise((resolve) => {
    const socket = connect(Number(url.port), url.hostname, () => {
      const all = { Host: url.host, Upgrade: 'websocket', Connection: 'Upgrade', 'Sec-WebSocket-Version': '13', 'Sec-WebSocket-Key': 'dGhlIHNhbXBsZSBub25jZQ==', ...headers };
      socket.write(`GET ${path} HTTP/1.1\r\n${Object.entries(all).map(([k, v]) => `${k}: ${v}\r\n`).join('')}\r\n`);
    });
    let text = '';
    const done = () => {
      socket.destroy();
      resolve(text.split('\r\n')[0]);
    };
    socket.on('data', (d) => {
      text += d;
      if (text.includes('\r\n')) done();
    });
    socket.on('close', done);
    socket.on('error', done);
  });
}

test('the page is compressed, under a megabyte, and allows no other origin', async () => {
  const page = await ask('/');
  assert.equal(page.status, 200);
  assert.match(page.headers['content-security-policy'], /default-src 'self'/);
  assert.equal(page.headers['x-content-type-options'], 'nosniff');
  assert.equal(page.headers['access-control-allow-origin'], undefined);
  const { gunzipSync } = await import('node:zlib');
  const html = gunzipSync(await rawBody('/')).toString();
  const assets = [...html.matchAll(/(?:src|href)="(\/assets\/[^"]+)"/g)].map((m) => m[1]);
  assert.ok(assets.length >= 2);
  let bytes = Number(page.headers['content-length']);
  for (const asset of assets) bytes += Number((await ask(asset)).headers['content-length']);
  assert.ok(bytes > 50_000 && bytes < 1_000_000, `${bytes} bytes`);
});

function rawBody(path) {
  const url = new URL(origin);
  return new Promise((resolve, reject) => {
    request({ host: url.hostname, port: url.port, path }, (answer) => {
      const pieces = [];
      answer.on('data', (d) => pieces.push(d));
      answer.on('end', () => resolve(Buffer.concat(pieces)));
    })
      .on('error', reject)
      .end();
  });
}

test('an answer is whole for a client that reads slowly and asks for the end of the connection', async () => {
  const { gunzipSync } = await import('node:zlib');
  const html = gunzipSync(await rawBody('/')).toString();
  const url = new URL(origin);
  for (const asset of [...html.matchAll(/(?:src|href)="(\/assets\/[^"]+)"/g)].map((m) => m[1])) {
    const whole = await rawBody(asset);
    const got = await new Promise((resolve) => {
      const pieces = [];
      const socket = connect(Number(url.port), url.hostname, () => socket.write(`GET ${asset} HTTP/1.1\r\nHost: ${url.host}\r\nConnection: close\r\n\r\n`));
      const done = () => resolve(Buffer.concat(pieces));
      socket.on('data', (d) => {
        pieces.push(d);
        socket.pause();
        setTimeout(() => socket.resume(), 20);
      });
      socket.on('error', done);
      socket.on('end', done);
    });
    const body = got.subarray(got.indexOf('\r\n\r\n') + 4);
    assert.equal(body.length, whole.length, asset);
    assert.ok(body.equals(whole), asset);
  }
});

test('requests with another Host or Origin are refused', async () => {
  assert.equal((await ask('/api/project')).status, 200);
  assert.equal((await ask('/api/project', { headers: { Host: 'evil.example' } })).status, 403);
  assert.equal((await ask('/api/project', { headers: { Host: `evil.example:${new URL(origin).port}` } })).status, 403);
  assert.equal((await ask('/api/project', { headers: { Origin: origin } })).status, 200);
  for (const foreign of ['http://evil.example', 'null', 'http://localhost:1'])
    assert.equal((await ask('/api/robot', { method: 'PUT', headers: { Origin: foreign }, body: 'name = "x"' })).status, 403, foreign);
});

test('a WebSocket from another page is refused', async () => {
  assert.match(await handshake({ Origin: origin }), /101/);
  assert.doesNotMatch(await handshake({ Origin: 'http://evil.example' }), /101/);
  assert.doesNotMatch(await handshake({}), /101/);
  assert.doesNotMatch(await handshake({ Origin: origin, Host: 'evil.example' }), /101/);
});

test('no path leads out of the project folder', async () => {
  writeFileSync(join(studio.folder, 'secret.txt'), 'secret');
  for (const path of ['/../../../../etc/passwd', '/..%2f..%2fetc/passwd', '/%2e%2e/%2e%2e/etc/passwd', '//etc/passwd', '/secret.txt', '/api/../secret.txt', '/assets/../../secret.txt']) {
    const answer = await ask(path);
    assert.ok(answer.status === 404 || answer.status === 400, `${path}: ${answer.status}`);
    assert.doesNotMatch(answer.text, /root:|secret\b.*secret/);
  }
  for (const name of ['../x.toml', '/etc/passwd', '..\\x.toml', 'a/../../x.toml', '/tmp/x.zip']) {
    for (const where of ['/api/open', '/api/robot/save']) {
      const answer = await ask(where, { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ name }) });
      assert.equal(answer.status, 422, `${where} ${name}: ${answer.text}`);
    }
  }
  const outside = 'name="x"\nlength_unit="mm"\nmaterial.a={youngs_modulus="1 MPa",poisson_ratio=0.4}\nbody=[{name="b",material="a",geometry="../../../../etc/passwd"}]\nfixed=[{name="f",box=[[0,0,0],[1,1,1]]}]\n';
  assert.equal((await ask('/api/robot', { method: 'PUT', body: outside })).status, 422);
});

test('uploads over the limit are refused, and the studio answers the next request', async () => {
  const answer = await ask('/api/robot', { method: 'PUT', body: Buffer.alloc(5 << 20, 'x') }).catch(() => ({ status: 413 }));
  assert.equal(answer.status, 413);
  assert.equal((await ask('/api/project')).status, 200);
});

test('bound to other addresses the studio needs its token', async () => {
  const open = await startStudio(['--bind', '0.0.0.0']);
  try {
    const url = new URL(open.address);
    const token = url.searchParams.get('token');
    assert.equal(token.length, 32);
    const address = `http://127.0.0.1:${url.port}`;
    assert.equal((await ask('/', {}, address)).status, 401);
    assert.equal((await ask('/api/project', {}, address)).status, 401);
    const refused = await ask(`/api/project?token=${'x'.repeat(32)}`, {}, address);
    assert.equal(refused.status, 401);
    assert.match(String(refused.text), /the token is wrong: use the address that the studio printed/);
    assert.doesNotMatch(await handshake({ Origin: address }, '/live', address), /101/);
    assert.equal((await ask('/api/project', { headers: { Authorization: `Bearer ${token}` } }, address)).status, 200);
    const first = await ask(`/?token=${token}`, {}, address);
    assert.equal(first.status, 302);
    const cookie = first.headers['set-cookie'][0];
    assert.match(cookie, /HttpOnly; SameSite=Strict/);
    assert.equal((await ask('/api/project', { headers: { Cookie: cookie.split(';')[0] } }, address)).status, 200);
    assert.match(await handshake({ Origin: address, Cookie: cookie.split(';')[0] }, '/live', address), /101/);
  } finally {
    await open.stop();
  }
});
