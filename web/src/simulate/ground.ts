// A soft shadow below the robot: low parts darken the ground more than high ones.
import * as THREE from 'three';

const pixels = 128;
/// Objects that cast a shadow are on this layer too.
export const shadowLayer = 1;

const vertexShader = 'varying vec2 at; void main() { at = uv; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }';

function blurMaterial() {
  return new THREE.ShaderMaterial({
    uniforms: { image: { value: null }, step: { value: new THREE.Vector2() } },
    vertexShader,
    fragmentShader: `uniform sampler2D image; uniform vec2 step; varying vec2 at;
      void main() {
        float sum = 0.0;
        float weights = 0.0;
        for (int k = -4; k <= 4; ++k) {
          float w = exp(-float(k * k) / 6.5);
          sum += w * texture2D(image, at + float(k) * step).a;
          weights += w;
        }
        gl_FragColor = vec4(0.0, 0.0, 0.0, sum / weights);
      }`,
    depthTest: false,
    depthWrite: false,
  });
}

/// Alpha encodes the height above the ground: dark where the robot is near.
function heightMaterial() {
  return new THREE.ShaderMaterial({
    vertexShader: 'varying float high; void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); high = gl_Position.z * 0.5 + 0.5; }',
    fragmentShader: 'varying float high; void main() { gl_FragColor = vec4(0.0, 0.0, 0.0, 0.06 + 0.94 * pow(clamp(1.0 - high, 0.0, 1.0), 2.0)); }',
    side: THREE.DoubleSide,
  });
}

export class Ground {
  readonly plane: THREE.Mesh;
  private readonly from = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);
  private readonly targets = [0, 1].map(() => new THREE.WebGLRenderTarget(pixels, pixels));
  private readonly height = heightMaterial();
  private readonly blur = blurMaterial();
  private readonly sheet = new THREE.Scene();
  private readonly flat = new THREE.OrthographicCamera(-0.5, 0.5, 0.5, -0.5, 0, 2);

  constructor() {
    this.plane = new THREE.Mesh(
      new THREE.PlaneGeometry(1, 1),
      new THREE.MeshBasicMaterial({ map: this.targets[0].texture, transparent: true, opacity: 0.62, depthWrite: false, toneMapped: false }),
    );
    this.plane.renderOrder = -1;
    this.from.layers.set(shadowLayer);
    this.flat.position.z = 1;
    this.sheet.add(new THREE.Mesh(new THREE.PlaneGeometry(1, 1), this.blur));
  }

  /// Places the shadow below a box, mm; call it when what stands on the ground has moved.
  update(renderer: THREE.WebGLRenderer, world: THREE.Scene, box: THREE.Box3) {
    const size = box.getSize(new THREE.Vector3());
    const centre = box.getCenter(new THREE.Vector3());
    const span = 1.5 * Math.max(size.x, size.y, 0.35 * size.z);
    const floor = box.min.z - 0.004 * span;
    this.plane.position.set(centre.x, centre.y, floor);
    this.plane.scale.set(-span, span, 1); // mirrored, because the picture is taken from below
    // From below, so that it sees what is nearest to the ground.
    this.from.left = this.from.bottom = -span / 2;
    this.from.right = this.from.top = span / 2;
    this.from.far = Math.max(0.45 * span, 1e-6);
    this.from.position.set(centre.x, centre.y, floor);
    this.from.up.set(0, 1, 0);
    this.from.lookAt(centre.x, centre.y, floor + 1);
    this.from.updateProjectionMatrix();
    this.render(renderer, world);
  }

  private render(renderer: THREE.WebGLRenderer, world: THREE.Scene) {
    const clear = renderer.getClearAlpha();
    const clipping = renderer.localClippingEnabled;
    const background = renderer.getRenderTarget();
    world.overrideMaterial = this.height;
    renderer.setClearAlpha(0);
    renderer.setRenderTarget(this.targets[0]);
    renderer.clear();
    renderer.render(world, this.from);
    world.overrideMaterial = null;
    for (const [into, step] of [[1, [1.6 / pixels, 0]], [0, [0, 1.6 / pixels]]] as const) {
      this.blur.uniforms.image.value = this.targets[1 - into].texture;
      this.blur.uniforms.step.value.set(...step);
      renderer.setRenderTarget(this.targets[into]);
      renderer.clear();
      renderer.render(this.sheet, this.flat);
    }
    renderer.setRenderTarget(background);
    renderer.setClearAlpha(clear);
    renderer.localClippingEnabled = clipping;
  }

  dispose() {
    for (const target of this.targets) target.dispose();
    this.height.dispose();
    this.blur.dispose();
  }
}
