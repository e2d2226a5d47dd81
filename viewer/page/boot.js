// In a page that is one file: unpacks the scripts, and the scene or the other files, that are inside it. A
// plain script, so that the import map, which says where each module is, is there before the first import.
(async () => {
    const bytes = id => {
        const packed = atob(document.getElementById(id).textContent),
            all = new Uint8Array(packed.length);
        for (let i = 0; i < all.length; i++) all[i] = packed.charCodeAt(i);
        return all;
    };
    // the files of a pack by their names
    const unpack = async id => {
        const unpacked = new Blob([bytes(id)]).stream().pipeThrough(new DecompressionStream("deflate")),
            all = new Uint8Array(await new Response(unpacked).arrayBuffer()),
            files = new Map();
        for (let at = 0; at < all.length;) {
            const line = all.indexOf(10, at),
                [name, size] = text.decode(all.subarray(at, line)).split(" ");
            at = line + 1 + Number(size);
            files.set(name, all.slice(line + 1, at));
        }
        document.getElementById(id).remove();
        return files;
    };
    const text = new TextDecoder(),
        imports = {};
    window.himcScripts = new Map();
    for (const [name, bytes] of await unpack("himc-scripts")) {
        const source = text.decode(bytes).replace(/ from "\.\//g, ' from "himc/');
        window.himcScripts.set(name, source);
        imports[`himc/${name}`] = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    }
    const map = document.createElement("script");
    map.type = "importmap";
    map.textContent = JSON.stringify({ imports });
    document.head.append(map);
    const scene = document.getElementById("himc-scene");
    if (scene) {
        window.himcScene = { name: scene.dataset.name, bytes: bytes("himc-scene") };
        scene.remove();
    } else window.himcFiles = await unpack("himc-files");
    await import("himc/main.js");
})();
