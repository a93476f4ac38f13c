// A client that others wrote (ws, which playwright-core contains) speaks the viewers' protocol with `rehearse serve`. What it
// gets is compared with the file of `rehearse export --viewer`, which @mcap/core reads.
// REHEARSE_COMMAND and SOURCES (the repository) are in the environment.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { indexedMessages } from '../interop/mcap_files.mjs';

const { REHEARSE_COMMAND, SOURCES } = process.env;
const { ws: WebSocket } = createRequire(import.meta.url)('../report/node_modules/playwright-core/lib/utilsBundle.js');
const scratch = mkdtempSync(join(tmpdir(), 'rehearse_serve_'));
const run = join(scratch, 'run.mcap');
const patience = 30_000; // [ms]
const [sdk, older] = ['foxglove.sdk.v1', 'foxglove.websocket.v1'];

const rehearse = (...words) => execFileSync(REHEARSE_COMMAND, words, { cwd: SOURCES, stdio: 'pipe', encoding: 'utf8' });

/** Starts the verb, and waits for its address. */
async function serve(...words) {
  const process = spawn(REHEARSE_COMMAND, ['serve', ...words], { cwd: SOURCES, stdio: ['ignore', 'pipe', 'pipe'] });
  const served = { process, out: '', err: '' };
  process.stderr.on('data', (text) => (served.err += text));
  process.stdout.on('data', (text) => (served.out += text));
  served.ended = new Promise((ended) => process.on('close', (status) => ended(status)));
  await until(() => served.out.includes('Ctrl-C'), () => served.out + served.err);
  served.address = /ws:\S+/.exec(served.out)[0];
  served.end = async () => {
    process.kill('SIGINT');
    return served.ended;
  };
  return served;
}

async function until(holds, found = () => '') {
  const end = performance.now() + patience;
  while (!holds()) {
    assert.ok(performance.now() < end, `nothing came in ${patience / 1000} s: ${found()}`);
    await new Promise((later) => setTimeout(later, 5));
  }
}

/** A viewer: what it was told, and the messages by topic. */
class Viewer {
  texts = [];
  channels = new Map();
  messages = []; // { topic, time, data }, in their order
  times = [];
  states = []; // of playback
  constructor(address, protocol = sdk, options = {}) {
    this.socket = new WebSocket(address, [protocol], options);
    this.socket.on('error', (error) => (this.error = error));
    this.socket.on('message', (data, isBinary) => (isBinary ? this.take(data) : this.read(JSON.parse(data))));
  }
  read(text) {
    this.texts.push(text);
    if (text.op === 'advertise') for (const channel of text.channels) this.channels.set(channel.id, channel);
  }
  take(data) {
    if (data[0] === 1)
      this.messages.push({
        topic: this.channels.get(this.subscribed[data.readUInt32LE(1)]).topic,
        time: data.readBigUInt64LE(5),
        data: data.subarray(13),
      });
    else if (data[0] === 2) this.times.push(data.readBigUInt64LE(1));
    else if (data[0] === 5)
      this.states.push({
        status: ['playing', 'paused', 'buffering', 'ended'][data[1]],
        time: data.readBigUInt64LE(2),
        speed: data.readFloatLE(10),
        id: data.subarray(18, 18 + data.readUInt32LE(14)).toString(),
      });
    else assert.fail(`an operation ${data[0]}`);
  }
  async opened(topics = 20) {
    await until(() => this.error || this.channels.size >= topics, () => JSON.stringify(this.texts));
    if (this.error) throw this.error;
    return this;
  }
  send(request) {
    this.socket.send(JSON.stringify(request));
  }
  subscribe(wanted = () => true) {
    const ids = [...this.channels.values()].filter(({ topic }) => wanted(topic)).map(({ id }) => id);
    this.subscribed = ids;
    this.send({ op: 'subscribe', subscriptions: ids.map((channelId, id) => ({ id, channelId })) });
  }
  control(id, { plays = true, speed = 1, seek = null }) {
    const request = Buffer.alloc(19 + id.length);
    request[0] = 3;
    request[1] = plays ? 0 : 1;
    request.writeFloatLE(speed, 2);
    request[6] = seek === null ? 0 : 1;
    request.writeBigUInt64LE(seek ?? 0n, 7);
    request.writeUInt32LE(id.length, 15);
    request.write(id, 19);
    this.socket.send(request);
  }
  async answered(id) {
    await until(() => this.states.some((state) => state.id === id));
    return this.states.find((state) => state.id === id);
  }
  close() {
    this.socket.terminate();
  }
}

/** The messages of a file by topic, each as its time and its bytes. */
async function messages_of(file) {
  const { reader, messages } = await indexedMessages(file);
  const topics = {};
  for (const message of messages) {
    const { topic } = reader.channelsById.get(message.channelId);
    (topics[topic] ??= []).push(`${message.logTime} ${Buffer.from(message.data).toString('base64')}`);
  }
  return topics;
}
const by_topic = (messages) => {
  const topics = {};
  for (const { topic, time, data } of messages) (topics[topic] ??= []).push(`${time} ${data.toString('base64')}`);
  return topics;
};

let served;
before(async () => {
  rehearse('record', 'fixtures/scenarios/sr1_minimum.yaml', '--duration', '0.5', '-o', run);
  served = await serve(run, '--port', '0');
});
after(async () => {
  await served?.end();
  rmSync(scratch, { recursive: true });
});

for (const protocol of [sdk, older])
  test(`a viewer gets each message of the file for viewers, by ${protocol}`, async () => {
    rehearse('export', run, '--viewer', join(scratch, 'viewer.mcap'), '--contacts');
    const expected = await messages_of(join(scratch, 'viewer.mcap'));
    const slow = await serve(run, '--port', '0', '--speed', '0.2'); // a busy machine loses no message
    const viewer = await new Viewer(slow.address, protocol).opened();
    assert.equal(viewer.socket.protocol, protocol);
    viewer.subscribe();
    await until(() => viewer.times.at(-1) === 500_000_000n);
    await until(() => viewer.messages.some(({ topic, time }) => topic === '/SR1/joints' && time === 500_000_000n));
    const got = by_topic(viewer.messages);
    assert.deepEqual(Object.keys(got).sort(), Object.keys(expected).sort());
    for (const [topic, messages] of Object.entries(expected))
      assert.deepEqual(got[topic], messages, `${topic}: ${JSON.stringify(viewer.texts.slice(2))}`);
    viewer.close();
    await slow.end();
  });

test('channels have their schemas, and lasting messages come at once', async () => {
  const viewer = await new Viewer(served.address).opened();
  const [info] = viewer.texts;
  assert.equal(info.op, 'serverInfo');
  assert.deepEqual(info.capabilities, ['time', 'parameters', 'parametersSubscribe', 'playbackControl']);
  assert.deepEqual([info.dataStartTime, info.dataEndTime], [{ sec: 0, nsec: 0 }, { sec: 0, nsec: 500_000_000 }]);
  for (const channel of viewer.channels.values()) {
    assert.equal(channel.encoding, 'cdr');
    assert.equal(channel.schemaEncoding, 'ros2msg');
    assert.ok(channel.schema.length > 5 && channel.schemaName.includes('/msg/'), channel.topic);
  }
  viewer.subscribe((topic) => topic === '/robot_description');
  await until(() => viewer.messages.length > 0);
  assert.match(viewer.messages[0].data.toString(), /<robot name="SR1"/);
  viewer.close();
});

test('a viewer pauses, searches, plays faster and plays to the end', async () => {
  const viewer = await new Viewer(served.address).opened();
  viewer.control('pause', { plays: false, seek: 250_500_000n });
  const paused = await viewer.answered('pause');
  assert.deepEqual([paused.status, paused.time], ['paused', 250_500_000n]);
  viewer.subscribe((topic) => ['/SR1/joints', '/SR1/LeftCamera/image', '/events'].includes(topic));
  // the last message of each topic before the moment; a camera takes a picture each 33 ms
  await until(() => viewer.messages.length >= 2);
  const seen = Object.fromEntries(viewer.messages.map(({ topic, time }) => [topic, time]));
  assert.equal(seen['/SR1/joints'], 250_000_000n);
  assert.ok(seen['/SR1/LeftCamera/image'] > 200_000_000n && seen['/SR1/LeftCamera/image'] <= 250_500_000n);
  const count = viewer.messages.length;
  await new Promise((later) => setTimeout(later, 200));
  assert.equal(viewer.messages.length, count, 'messages come while it is paused');
  viewer.control('back', { plays: false, seek: 100_000_000n });
  assert.equal((await viewer.answered('back')).time, 100_000_000n);
  await until(() => viewer.messages.at(-1).time <= 100_000_000n);
  viewer.control('far', { plays: false, seek: 2n ** 63n });
  assert.equal((await viewer.answered('far')).time, 500_000_000n);
  viewer.messages = [];
  viewer.control('play', { speed: 2, seek: 100_000_000n });
  const playing = await viewer.answered('play');
  assert.deepEqual([playing.status, playing.speed], ['playing', 2]);
  await until(() => viewer.states.at(-1).status === 'ended');
  await until(() => viewer.messages.some(({ topic, time }) => topic === '/SR1/joints' && time === 500_000_000n));
  const joints = viewer.messages.filter(({ topic }) => topic === '/SR1/joints').map(({ time }) => time);
  assert.deepEqual(joints, Array.from({ length: 401 }, (_, i) => BigInt(100 + i) * 1_000_000n));
  viewer.close();
});

test('parameters are the values of the scenario, and stay so', async () => {
  const viewer = await new Viewer(served.address).opened();
  const answers = (id) => viewer.texts.find((text) => text.op === 'parameterValues' && text.id === id);
  viewer.send({ op: 'getParameters', parameterNames: ['time_step', 'scenario', 'SR1.SR1Minimum.library'], id: 'a' });
  await until(() => answers('a'));
  assert.deepEqual(
    Object.fromEntries(answers('a').parameters.map(({ name, value }) => [name, value])),
    { scenario: 'sr1_minimum', time_step: 0.001, 'SR1.SR1Minimum.library': 'SR1MinimumController' },
  );
  viewer.send({ op: 'setParameters', parameters: [{ name: 'time_step', value: 1 }], id: 'b' });
  await until(() => answers('b'));
  assert.equal(answers('b').parameters.find(({ name }) => name === 'time_step').value, 0.001);
  assert.ok(viewer.texts.some(({ op, message }) => op === 'status' && message.includes("can't be changed")));
  viewer.close();
});

test('a viewer that takes nothing delays no other', async () => {
  const viewers = [];
  for (let i = 0; i < 8; ++i) viewers.push(await new Viewer(served.address).opened());
  viewers[0].subscribe();
  viewers[0].socket.pause();
  for (const viewer of viewers.slice(1)) viewer.subscribe((topic) => topic === '/SR1/joints');
  viewers[1].control('again', { seek: 0n });
  for (const viewer of viewers.slice(1)) {
    await until(() => viewer.messages.some(({ time }) => time === 500_000_000n));
    assert.ok(viewer.messages.length >= 501, `${viewer.messages.length} messages`);
  }
  for (const viewer of viewers) viewer.close();
});

test('strangers get nothing', async () => {
  const refused = async (address, protocol, options) => {
    const viewer = new Viewer(address, protocol, options);
    await until(() => viewer.error);
    assert.deepEqual(viewer.texts, []);
    return viewer.error.message;
  };
  const bare = served.address.replace(/\?.*/, '');
  assert.match(await refused(bare, sdk), /403/);
  assert.match(await refused(served.address, 'chat'), /400/);
  assert.match(await refused(served.address, sdk, { origin: 'https://evil.example.com' }), /403/);
  assert.match(await refused(served.address, sdk, { headers: { host: 'evil.example.com' } }), /403/);
  await until(() => served.err.includes('refused a connection: pages of https://evil.example.com may not connect'));
  const page = await fetch(bare.replace('ws:', 'http:'));
  assert.equal(page.status, 403);
  assert.equal(page.headers.get('access-control-allow-origin'), null);
  await (await new Viewer(served.address, sdk, { origin: 'https://app.foxglove.dev' }).opened()).close();
});

test('it listens on the loopback interface alone', () => {
  const port = Number(/:(\d+)/.exec(served.address)[1]).toString(16).toUpperCase().padStart(4, '0');
  const listening = ['tcp', 'tcp6']
    .flatMap((table) => readFileSync(`/proc/net/${table}`, 'utf8').split('\n'))
    .map((line) => line.trim().split(/\s+/))
    .filter(([, local, , state]) => state === '0A' && local.endsWith(`:${port}`));
  assert.deepEqual(listening.map(([, local]) => local), [`0100007F:${port}`]);
});

test('a port in use names its program, a file without messages is refused, and Ctrl-C ends it', async () => {
  const taken = createServer();
  await new Promise((listening) => taken.listen(0, '127.0.0.1', listening));
  const failure = (...words) => {
    try {
      rehearse('serve', ...words);
    } catch ({ status, stderr }) {
      return `${status}: ${stderr}`;
    }
    return assert.fail('it serves');
  };
  const { port } = taken.address();
  assert.match(failure(run, '--port', String(port)), new RegExp(`^2: error: \\S+ \\(process ${process.pid}\\) has the port ${port} `));
  taken.close();
  assert.match(failure('nothing.mcap'), /^2: nothing.mcap: error: /);
  writeFileSync(join(scratch, 'damaged.mcap'), readFileSync(run).subarray(0, 20_000));
  assert.match(failure(join(scratch, 'damaged.mcap')), /^2: .*there is no message to serve/s);
  const other = await serve(run, '--port', '0');
  const viewer = await new Viewer(other.address).opened();
  let ended = false;
  viewer.socket.on('close', (code) => (ended = code === 1001 || code === 1006));
  assert.equal(await other.end(), 130);
  await until(() => ended);
});

test('a golden is served by its name, and a cut recording up to its cut', async () => {
  const golden = await serve('Spring.SwingsWithItsNaturalFrequency', '--port', '0');
  const viewer = await new Viewer(golden.address).opened(5);
  viewer.subscribe((topic) => topic.endsWith('/joints'));
  await until(() => viewer.messages.length > 10);
  viewer.close();
  await golden.end();
  const whole = readFileSync(run);
  writeFileSync(join(scratch, 'cut.mcap'), whole.subarray(0, Math.floor(whole.length * 0.9)));
  const cut = await serve(join(scratch, 'cut.mcap'), '--port', '0');
  assert.match(cut.err, /cut/);
  const other = await new Viewer(cut.address).opened(5);
  other.subscribe();
  await until(() => other.messages.length > 100);
  other.close();
  await cut.end();
});

const hash = (file) => createHash('sha256').update(readFileSync(file)).digest('hex');
/** Records the scenario with --live and so many viewers; returns what `look` finds in them, and the recording's hash. */
async function record_live(count, look = () => null) {
  const file = join(scratch, `live_${count}.mcap`);
  const recorder = spawn(
    REHEARSE_COMMAND,
    ['record', 'fixtures/scenarios/sr1_minimum.yaml', '--duration', '3', '-o', file, '--live', '--port', '0'],
    { cwd: SOURCES, stdio: ['ignore', 'pipe', 'pipe'] },
  );
  let told = '';
  recorder.stderr.on('data', (text) => (told += text));
  recorder.stdout.resume();
  const ended = new Promise((end) => recorder.on('close', end));
  await until(() => told.includes('Ctrl-C'), () => told);
  const address = /ws:\S+/.exec(told)[0];
  const viewers = Array.from({ length: count }, () => new Viewer(address));
  for (const [i, viewer] of viewers.entries()) {
    await viewer.opened();
    viewer.subscribe(i === 0 ? (topic) => topic !== '/SR1/LeftCamera/depth' && topic !== '/SR1/RightCamera/depth' : undefined);
    if (i === 1) viewer.socket.pause();
  }
  assert.equal(await ended, 0, told);
  const found = await look(viewers, file);
  for (const viewer of viewers) viewer.close();
  return { found, hash: hash(file) };
}

test('a run that is watched has the same bits, and its viewer gets all of it', async () => {
  const alone = await record_live(0);
  const watched = await record_live(1, async ([viewer], file) => {
    await until(() => viewer.texts.some(({ op, message }) => op === 'status' && message.includes('the run has ended')));
    const got = by_topic(viewer.messages);
    const view = join(scratch, 'live.viewer.mcap');
    rehearse('export', file, '--viewer', view, '--contacts');
    const expected = await messages_of(view);
    for (const topic of Object.keys(got)) {
      const begin = expected[topic].indexOf(got[topic][0]); // a viewer that comes late gets the rest
      assert.ok(begin >= 0, `${topic} has a message that the recording lacks: ${got[topic][0].slice(0, 40)}, ${expected[topic][0].slice(0, 40)}`);
      assert.deepEqual(got[topic], expected[topic].slice(begin), topic);
    }
    return got['/SR1/joints'].length;
  });
  assert.ok(watched.found > 1500, `${watched.found} of 3001 messages`);
  const eight = await record_live(8);
  assert.deepEqual([watched.hash, eight.hash], [alone.hash, alone.hash]);
});

test('a run with --live on a port in use is not begun', async () => {
  const taken = createServer();
  await new Promise((listening) => taken.listen(0, '127.0.0.1', listening));
  const file = join(scratch, 'not_begun.mcap');
  const outcome = spawnSync(
    REHEARSE_COMMAND,
    ['record', 'fixtures/scenarios/sr1_minimum.yaml', '--duration', '0.1', '-o', file, '--live', '--port', String(taken.address().port)],
    { cwd: SOURCES, encoding: 'utf8' },
  );
  taken.close();
  assert.equal(outcome.status, 2);
  assert.match(outcome.stderr, /has the port/);
  assert.ok(!existsSync(file));
});
