// Scenes in the address: the text, compressed by deflate, in base64url, after `#scene=`.

const PREFIX = "#scene=";
// Bytes that a text of an address may have. Deflate can hold a thousand times its size, and an address may come from anybody.
const MOST_BYTES = 16e6;
// Bytes that are decompressed at a time. A browser decompresses what it is given before it looks whether anybody reads.
const SLICE = 4096;

// Every promise is awaited, because Firefox reports an error of `pipeThrough` a second time, as one that nobody handles.
async function through(stream, bytes, most) {
    const writer = stream.writable.getWriter();
    const write = async () => {
        for (let start = 0; start < bytes.length; start += SLICE) await writer.write(bytes.subarray(start, start + SLICE));
        await writer.close();
    };
    const reader = stream.readable.getReader();
    const read = async () => {
        const parts = [];
        for (let length = 0; ; ) {
            const { done, value } = await reader.read();
            if (done) return parts;
            parts.push(value);
            length += value.length;
            if (length > most) {
                const error = new RangeError(`more than ${most} bytes`);
                await reader.cancel(error);
                throw error;
            }
        }
    };
    const [parts] = await Promise.all([read(), write()]);
    return new Uint8Array(await new Blob(parts).arrayBuffer());
}

export async function toFragment(text) {
    const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(text), Infinity);
    let binary = "";
    for (const byte of bytes) binary += String.fromCharCode(byte);
    return PREFIX + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

// The scene text of a fragment; `null` if it has none. Rejects if it is damaged or too long.
export async function fromFragment(fragment) {
    if (!fragment.startsWith(PREFIX)) return null;
    try {
        const binary = atob(fragment.slice(PREFIX.length).replaceAll("-", "+").replaceAll("_", "/"));
        const bytes = Uint8Array.from(binary, letter => letter.charCodeAt(0));
        return new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes, MOST_BYTES));
    } catch (error) {
        throw new Error(error instanceof RangeError
            ? `The address contains a scene that is too long: expected a text of at most ${MOST_BYTES / 1e6} MB.`
            : "The address contains a scene that is damaged, perhaps because it was cut off.");
    }
}
