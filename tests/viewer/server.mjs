// A web server for the viewer: files by the names of their addresses, whole or in ranges of bytes.
import { createReadStream, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname } from 'node:path';

const types = {
  '.css': 'text/css',
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.json': 'application/json',
  '.wasm': 'application/wasm',
};

function size_of(file) {
  const found = file && statSync(file, { throwIfNoEntry: false });
  return found?.isFile() ? found.size : null;
}

/** `file_of(path)`: the file of an address; null: there is none. Listens on a free port of this machine. */
export async function serve(file_of) {
  const server = createServer((request, response) => {
    const file = file_of(new URL(request.url, 'http://localhost').pathname);
    const size = size_of(file);
    if (size === null) {
      response.writeHead(404).end();
      return;
    }
    const range = /^bytes=(\d+)-(\d*)$/.exec(request.headers.range ?? '');
    const first = range ? Number(range[1]) : 0;
    const last = range?.[2] ? Math.min(Number(range[2]), size - 1) : size - 1;
    response.writeHead(range ? 206 : 200, {
      'content-type': types[extname(file)] ?? 'application/octet-stream',
      'content-length': last - first + 1,
      'accept-ranges': 'bytes',
      ...(range && { 'content-range': `bytes ${first}-${last}/${size}` }),
    });
    if (request.method === 'HEAD') response.end();
    else createReadStream(file, { start: first, end: last }).pipe(response);
  });
  await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
  return { address: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}
