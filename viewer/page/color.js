// Colours as one picks them, for lights and materials that reckon in linear light.
import * as THREE from "./three.js";

export const rgb = name => new THREE.Color(name).convertSRGBToLinear();

export function picture(canvas) {
    const texture = new THREE.CanvasTexture(canvas);
    texture.encoding = THREE.sRGBEncoding;
    return texture;
}
