// Scenes in the address: the text, compressed by deflate, in base64url, after `#scene=`.

const PREFIX = "#scene=";

async function through(stream, bytes) {
    const answer = new Response(new Blob([bytes]).stream().pipeThrough(stream));
    return new Uint8Array(await answer.arrayBuffer());
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
