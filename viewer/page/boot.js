// In a page of `himc share`: unpacks the scripts and the scene that are inside it. A plain script, so
// that the import map, which says where each module is, is there before the first import.
(async () => {
    const bytes = id =>
        Uint8Array.from(atob(document.getElementById(id).textContent), c => c.charCodeAt(0));
    const unpacked = new Blob([bytes("himc-scripts")])
        .stream()
        .pipeThrough(new DecompressionStream("deflate"));
    const all = new Uint8Array(await new Response(unpacked).arrayBuffer()),
        text = new TextDecoder(),
        imports = {};
    for (let at = 0; at < all.length;) {
        const line = all.indexOf(10, at),
            [name, size] = text.decode(all.subarray(at, line)).split(" "),
            source = text.decode(all.subarray(line + 1, line + 1 + Number(size)));
        imports[`himc/${name}`] = URL.createObjectURL(
            new Blob([source.replace(/ from "\.\//g, ' from "himc/')], { type: "text/javascript" }),
        );
        at = line + 1 + Number(size);
    }
    const map = document.createElement("script");
    map.type = "importmap";
    map.textContent = JSON.stringify({ imports });
    document.head.append(map);
    const scene = document.getElementById("himc-scene");
    window.himcScene = { name: scene.dataset.name, bytes: bytes("himc-scene") };
    scene.remove();
    await import("himc/main.js");
})();
