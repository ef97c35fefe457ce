/// Turns the user's input in the picture into motions of the camera and clicks.
class Controls {
  /// on: {changed(), click(x, y) (client coordinates), clickMiddle(), point({x, y} or null), isDragged() (whether drags
  /// are a tool's), beginDrag(x, y) -> whether this one is, drag(x, y), endDrag(x, y), cancelDrag()}
  constructor(canvas, camera, on) {
    this.canvas = canvas;
    this.camera = camera;
    this.on = on;
    this.touches = new Map();  // by pointer: {x, y}
    this.held = null;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", (event) => {
      if (this.held?.isTool) on.cancelDrag();
      this.touches.delete(event.pointerId);
      this.held = null;
    });
    canvas.addEventListener("pointerleave", () => on.point(null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      camera.approach(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 500))));
      on.changed();
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => this.press(event));
  }

  down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.touches.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (this.held?.isTool) this.on.cancelDrag();
    // While drags belong to a tool, the right button turns.
    const turns = event.button === 0 || (event.button === 2 && this.on.isDragged());
    this.held = { x: event.clientX, y: event.clientY, travelled: this.touches.size > 1 ? Infinity : 0, slides: event.shiftKey || !turns };
    this.held.isTool = event.button === 0 && !event.shiftKey && this.touches.size === 1 && this.on.beginDrag(event.clientX, event.clientY);
  }

  move(event) {
    if (event.pointerType === "mouse") this.on.point({ x: event.clientX, y: event.clientY });
    const before = this.touches.get(event.pointerId);
    if (!before || !this.held) return;
    const here = { x: event.clientX, y: event.clientY };
    const unit = 1 / Math.max(1, this.canvas.clientHeight);
    if (this.touches.size === 2) this.pinch(event.pointerId, before, here, unit);
    else if (this.touches.size === 1) {
      this.held.travelled += Math.abs(here.x - before.x) + Math.abs(here.y - before.y);
      const least = event.pointerType === "touch" ? 10 : 4;
      if (this.held.travelled >= least && this.held.isTool) this.on.drag(here.x, here.y);
      else if (this.held.travelled >= least) this.drag((here.x - before.x) * unit, (here.y - before.y) * unit);
    }
    this.touches.set(event.pointerId, here);
    this.on.changed();
  }
  drag(dx, dy) {
    if (this.held.slides) this.camera.slide(dx, dy);
    else this.camera.turn(dx * 3, dy * 3);
  }

  /// Two fingers: their distance is the zoom, their middle the position.
  pinch(id, before, here, unit) {
    const [other] = [...this.touches].filter(([each]) => each !== id).map(([, place]) => place);
    const apart = (place) => Math.max(10, Math.hypot(place.x - other.x, place.y - other.y));
    this.camera.approach(apart(before) / apart(here));
    this.camera.slide(((here.x - before.x) / 2) * unit, ((here.y - before.y) / 2) * unit);
  }

  up(event) {
    this.touches.delete(event.pointerId);
    const least = event.pointerType === "touch" ? 10 : 4;
    if (this.held && this.held.travelled < least && event.button === 0 && this.touches.size === 0) this.on.click(event.clientX, event.clientY);
    else if (this.held?.isTool && this.touches.size === 0) this.on.endDrag(event.clientX, event.clientY);
    if (this.touches.size === 0) this.held = null;
  }

  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (step && event.shiftKey) this.camera.slide(-step[0] * 0.05, -step[1] * 0.05);
    else if (step) this.camera.turn(step[0] * 0.1, -step[1] * 0.1);
    else if (event.key === "Enter") this.on.clickMiddle();
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.on.changed();
  }
}
