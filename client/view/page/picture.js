const kSharpest = 2;
// Coarser outlines would show steps, and save little: most of the time goes into the second pass. On a screen with more
// than one pixel for each of CSS the whole picture may be coarser (Renderer.resize).
const kCoarsest = 0.7;

/// The picture: draws the world when something has changed, as sharp as time allows.
class Picture {
  /// on: {failed(error)}: there is no picture from now on
  constructor(canvas, overlay, on) {
    this.canvas = canvas;
    this.on = on;
    this.frames = [];        // time that each of the newest pictures took, ms
    this.labels = new Labels(overlay);
    this.marks = new Marks();
    this.isDirty = true;
    this.motionSharpness = 1;  // of pictures while something moves
    this.median_ms = Infinity;  // time of such a picture
    try {
      this.renderer = new Renderer(canvas);
    } catch (failed) {
      this.failed = failed;
      this.renderer = null;
    }
  }

  size() { return [this.canvas.clientWidth, Math.max(1, this.canvas.clientHeight)]; }

  /// Draws if there is something new; returns whether it did. shown: {world, camera, contacts, standing, isShown(pair),
  /// labelled()}.
  draw(now, { world, camera, contacts, standing, isShown, labelled }) {
    if (this.hasDrawn) this.note(now - this.calledAt);
    this.calledAt = now;
    this.hasDrawn = false;
    if (!this.renderer) return false;
    const isAnimated = this.marks.place(contacts, standing, world, camera, this.size(), isShown, now);
    const isNew = this.isDirty || isAnimated || this.marks.count !== this.marksBefore || world.statesChanged;
    if (isNew) this.movedAt = now;
    const isSharper = !isNew && this.wantsSharper(now);
    if (!isNew && !isSharper) return false;
    const { renderer } = this;
    renderer.sharpness = isSharper ? this.stillSharpness() : this.motionSharpness;
    renderer.resize();
    camera.aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
    const isStillChanged = world.stillStatesChanged;
    world.send(camera, renderer.seenSize);
    this.isDirty = true;
    if (!this.isPrepared()) return false;
    this.isSharper = isSharper;
    this.hasDrawn = isNew;
    this.isDirty = false;
    this.marksBefore = this.marks.count;
    this.render(world, camera, labelled, isStillChanged);
    return true;
  }

  /// Whether the shaders are ready; until WebGL confirms them there is no picture.
  isPrepared() {
    try {
      return this.renderer.prepare();
    } catch (failed) {
      this.failed = failed;
      this.renderer = null;
      this.on.failed(failed);
      return false;
    }
  }

  render(world, camera, labelled, isStillChanged) {
    this.renderer.fill(this.renderer.marks, this.marks.data, this.marks.count);
    const { near, far } = this.depths(world, camera);
    this.grid = 10 ** Math.round(Math.log10(Math.max(1e-6, camera.distance) / 12));
    const ground = world.bounds.isEmpty() ? 0 : world.bounds.low[camera.yIsUp ? 1 : 2];
    const region = this.changedRegion(world, camera, isStillChanged);
    this.renderer.draw(camera, { near, far, anchor: world.anchor, ground, grid: this.grid, stillVersion: world.stillVersion, region });
    this.labels.draw(camera, this.size(), this.marks.texts, labelled());
  }

  /// Where this picture differs from the last one, if the camera has not moved (the renderer checks that).
  changedRegion(world, camera, isStillChanged) {
    const [width, height] = this.size();
    const grow_px = 4;
    const now = this.marks.region(world.movingRegion(camera, grow_px / width, grow_px / height), camera, width, height);
    const before = this.regionBefore;
    this.regionBefore = now;
    if (!now || !before || isStillChanged || this.isSharper || this.wasSharper !== this.isSharper) {
      this.wasSharper = this.isSharper;
      return null;
    }
    const most = (i) => (i < 2 ? Math.min(now[i], before[i]) : Math.max(now[i], before[i]));
    return [0, 1, 2, 3].map(most);
  }

  depths(world, camera) {
    const away = length(subtract(camera.eye(), world.bounds.center()));
    const radius = world.bounds.radius();
    const far = Math.max(camera.distance * 4, away + radius * 8);
    // Half the distance to the nearest possible object; an eye among them sees from a fiftieth of its distance on.
    const near = Math.max(far * 1e-5, camera.distance * 0.02, (away - radius * 1.1) * 0.5);
    return { near: Math.min(near, camera.distance * 0.5), far };
  }

  // ---- how sharp

  /// When nothing has moved for a while there is time for one picture that is as sharp as the screen, or sharper.
  wantsSharper(now) {
    const pause_ms = 250;
    return now - (this.movedAt ?? now) > pause_ms && this.renderer.sharpness < this.stillSharpness();
  }
  stillSharpness() {
    const finest = kSharpest / Math.min(kSharpest, window.devicePixelRatio || 1);
    const most_ms = 800;
    return this.median_ms * (finest / this.motionSharpness) ** 2 < most_ms ? finest : Math.max(1, this.motionSharpness);
  }

  /// Takes the time of a picture, in ms. Pictures become coarser if they take too long, and finer if there is time.
  note(took) {
    if (took > 5000) return;  // the page was hidden
    this.frames.push(took);
    if (this.frames.length > 240) this.frames.shift();
    this.sinceChange = (this.sinceChange || 0) + 1;
    if (this.sinceChange < 5) return;
    const recent = this.frames.slice(-Math.min(20, this.sinceChange)).sort((a, b) => a - b);
    const median = recent[Math.floor(recent.length / 2)];
    this.median_ms = median;
    const finest = kSharpest / Math.min(kSharpest, window.devicePixelRatio || 1);
    const coarsest = kCoarsest / Math.max(1, window.devicePixelRatio || 1);
    const isSlow = median > 180 || (median > 90 && this.sinceChange >= 20);
    if (isSlow && this.motionSharpness > coarsest) this.motionSharpness = Math.max(coarsest, this.motionSharpness * 0.8);
    else if (median < 40 && this.motionSharpness < 1 && this.sinceChange > 60) this.motionSharpness = Math.min(1, this.motionSharpness / 0.8);
    else if (median < 20 && this.motionSharpness < finest && this.sinceChange > 120) this.motionSharpness = finest;
    else return;
    this.sinceChange = 0;
  }

  /// The quality as text: pictures per second, and whether they are coarser than the screen.
  qualityText() {
    const recent = this.frames.slice(-20);
    if (!this.renderer) return "";
    const took = recent.length ? recent.reduce((sum, one) => sum + one, 0) / recent.length : 0;
    const time = took ? `${Math.round(took)} ms a picture` : "";
    const coarse = this.renderer.sharpness < 0.995 ? `outlines from ${Math.round(100 * this.renderer.sharpness)} % of the pixels, to keep up` : "full resolution";
    return [coarse, time].filter(Boolean).join(" · ");
  }
  isCoarse() { return Boolean(this.renderer) && this.renderer.sharpness < 0.995; }
}
