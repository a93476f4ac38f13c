// The drop zone of the playground: shows what the summary of an MCAP file states. The file is read in the browser, from
// its end: only its summary, whatever its size, and nothing leaves the machine.
import { McapIndexedReader } from '@mcap/core';

/** A file as @mcap/core reads it. */
class FileReadable {
  constructor(file) {
    this.file = file;
  }
  async size() {
    return BigInt(this.file.size);
  }
  async read(offset, size) {
    const end = Number(offset + size);
    if (end > this.file.size) throw new Error(`the file ends at byte ${this.file.size}, before byte ${end}`);
    return new Uint8Array(await this.file.slice(Number(offset), end).arrayBuffer());
  }
}

const seconds = (nanoseconds) => Number(nanoseconds) / 1e9;
const bytes = (count) => (count < 1e6 ? `${(count / 1e3).toFixed(1)} kB` : `${(count / 1e6).toFixed(1)} MB`);

/** What is shown of a file: {facts: [[name, text]], channels: [[topic, type, messages, rate]]}. */
async function summaryOf(file) {
  const reader = await McapIndexedReader.Initialize({ readable: new FileReadable(file) });
  const { statistics } = reader;
  const begin = statistics?.messageStartTime ?? 0n;
  const duration = seconds((statistics?.messageEndTime ?? 0n) - begin);
  const facts = [
    ['file', `${file.name}, ${bytes(file.size)}`],
    ['written by', [reader.header.library, reader.header.profile].filter(Boolean).join(', profile ')],
    ['duration', `${duration} s`],
    // log times of Rehearse begin with 0; those of robots count from 1970
    ['begin', begin < 1_000_000_000_000_000n ? `${seconds(begin)} s` : new Date(seconds(begin) * 1e3).toISOString()],
    ['messages', statistics ? String(statistics.messageCount) : 'not stated'],
    ['chunks', `${reader.chunkIndexes.length}, ${[...new Set(reader.chunkIndexes.map((chunk) => chunk.compression || 'none'))].join(', ')}`],
    ['attachments', reader.attachmentIndexes.map(({ name }) => name).join(', ') || 'none'],
    ['metadata', [...new Set(reader.metadataIndexes.map(({ name }) => name))].join(', ') || 'none'],
  ];
  const channels = [...reader.channelsById.values()].map((channel) => {
    const count = Number(statistics?.channelMessageCounts.get(channel.id) ?? 0n);
    const type = reader.schemasById.get(channel.schemaId)?.name ?? channel.messageEncoding;
    return [channel.topic, type, String(count), duration > 0 && count > 1 ? `${((count - 1) / duration).toPrecision(4)} Hz` : ''];
  });
  return { facts, channels };
}

function element(name, parent, text = '') {
  const made = document.createElement(name);
  made.textContent = text;
  parent.append(made);
  return made;
}

function rows(table, lines, kind = 'td') {
  for (const line of lines) {
    const row = element('tr', table);
    line.forEach((cell) => element(kind, row, cell));
  }
}

async function show(file, place) {
  place.replaceChildren();
  place.dataset.state = 'reading';
  try {
    const { facts, channels } = await summaryOf(file);
    const head = element('table', place);
    head.className = 'docutils';
    rows(head, facts);
    const table = element('table', place);
    table.className = 'docutils';
    rows(element('thead', table), [['topic', 'type', 'messages', 'rate']], 'th');
    rows(element('tbody', table), channels);
    place.dataset.state = 'shown';
  } catch (error) {
    element('p', place, `${file.name} can't be read: ${error.message}. A file that was cut has no summary; rehearse recover makes a whole one.`);
    place.dataset.state = 'refused';
  }
}

const zone = document.getElementById('drop-zone');
const place = document.getElementById('drop-result');
const chosen = document.getElementById('drop-file');
chosen.addEventListener('change', () => chosen.files[0] && show(chosen.files[0], place));
for (const event of ['dragenter', 'dragover'])
  zone.addEventListener(event, (moved) => {
    moved.preventDefault();
    zone.classList.add('over');
  });
for (const event of ['dragleave', 'drop']) zone.addEventListener(event, () => zone.classList.remove('over'));
zone.addEventListener('drop', (dropped) => {
  dropped.preventDefault();
  if (dropped.dataTransfer.files[0]) show(dropped.dataTransfer.files[0], place);
});
