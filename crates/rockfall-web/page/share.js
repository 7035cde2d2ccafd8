// Scenes in the address: the text, compressed by deflate, in base64url, after `#scene=`.

const PREFIX = "#scene=";

// Every promise is awaited, because Firefox reports an error of `pipeThrough` a second time, as one that nobody handles.
async function through(stream, bytes) {
    const writer = stream.writable.getWriter();
    const written = writer.write(bytes).then(() => writer.close());
    const reader = stream.readable.getReader();
    const read = async () => {
        const parts = [];
        for (;;) {
            const { done, value } = await reader.read();
            if (done) return parts;
            parts.push(value);
        }
    };
    const [parts] = await Promise.all([read(), written]);
    return new Uint8Array(await new Blob(parts).arrayBuffer());
}

export async function toFragment(text) {
    const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(text));
    let binary = "";
    for (const byte of bytes) binary += String.fromCharCode(byte);
    return PREFIX + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

// The scene text of a fragment; `null` if it has none. Rejects if it is damaged.
export async function fromFragment(fragment) {
    if (!fragment.startsWith(PREFIX)) return null;
    try {
        const binary = atob(fragment.slice(PREFIX.length).replaceAll("-", "+").replaceAll("_", "/"));
        const bytes = Uint8Array.from(binary, letter => letter.charCodeAt(0));
        return new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes));
    } catch {
        throw new Error("The address contains a scene that is damaged, perhaps because it was cut off.");
    }
}
