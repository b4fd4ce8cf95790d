// What view3d.js uses of three.js; three.min.js is made from it and three 0.185.1 with esbuild 0.28.2:
//   npm install three@0.185.1 esbuild@0.28.2
//   npx esbuild three.entry.js --bundle --minify --format=iife --global-name=THREE --legal-comments=none
//     --alias:three=./node_modules/three/build/three.module.min.js --banner:js="/*! $(cat three.LICENSE.txt) */"
//     --outfile=three.min.js
export {
  AmbientLight, BufferAttribute, BufferGeometry, ColorManagement, DirectionalLight, LinearSRGBColorSpace, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Scene, Spherical, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "./node_modules/three/examples/jsm/controls/OrbitControls.js";
