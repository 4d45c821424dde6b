// What three.js makes of a BVH, as JSON: node read_bvh_three.mjs FILE FRAME,FRAME…
// Its BVHLoader adds every position channel to OFFSET, also of the root.
import fs from 'node:fs';
import { Vector3 } from 'three';
import { BVHLoader } from 'three/examples/jsm/loaders/BVHLoader.js';

const [file, wanted] = process.argv.slice(2);
const messages = [];
console.error = (...words) => messages.push(words.join(' '));
console.warn = console.error;

const { skeleton, clip } = new BVHLoader().parse(new TextDecoder().decode(fs.readFileSync(file)));
const joints = skeleton.bones.filter((bone) => bone.name !== 'ENDSITE');
const [first] = clip.tracks; // two tracks a joint, position and quaternion, in the order of the joints
const positions = {};
for (const frame of wanted.split(',').map(Number)) {
  joints.forEach((bone, joint) => {
    bone.position.fromArray(clip.tracks[2 * joint].values, 3 * frame);
    bone.quaternion.fromArray(clip.tracks[2 * joint + 1].values, 4 * frame);
  });
  skeleton.bones[0].updateMatrixWorld(true);
  positions[frame] = Object.fromEntries(
    joints.map((bone) => [bone.name, new Vector3().setFromMatrixPosition(bone.matrixWorld).toArray()]),
  );
}
console.log(JSON.stringify({
  three: {
    frames: first.times.length,
    frame_time: first.times[1] - first.times[0],
    joints: joints.map((bone) => bone.name),
    parents: Object.fromEntries(joints.map((bone) => [bone.name, bone.parent?.isBone ? bone.parent.name : null])),
    positions,
    warnings: messages,
  },
}));
