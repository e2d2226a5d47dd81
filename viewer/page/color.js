// sRGB colours converted to linear light, in which three.js computes lights and materials.
import * as THREE from "./three.js";

export const rgb = name => new THREE.Color(name).convertSRGBToLinear();

export function picture(canvas) {
    const texture = new THREE.CanvasTexture(canvas);
    texture.encoding = THREE.sRGBEncoding;
    return texture;
}
