const kMostLabels = 80;

/// Texts over the picture, on a canvas of their own, so that they stay sharp when the picture is drawn coarser.
class Labels {
  constructor(canvas) {
    this.canvas = canvas;
    this.areShown = false;
    this.placed = [];  // [left, top, right, bottom, text] of the last picture
  }

  /// marks: texts at points, which come first; objects: candidates for names, the most important first.
  draw(camera, [width, height], marks, objects) {
    const areAny = marks.length > 0 || objects.length > 0;
    if (!areAny && this.placed.length === 0) return;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const pen = penOf(this.canvas);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const style = getComputedStyle(document.documentElement);
    this.colors = { ink: style.getPropertyValue("--ink"), paper: style.getPropertyValue("--paper"), accent: style.getPropertyValue("--accent-text") };
    pen.font = "11px 'DejaVu Sans', Arial, sans-serif";
    pen.textBaseline = "middle";
    this.placed = [];
    for (const { point, text, beside } of marks) this.put(pen, camera, width, height, point, text, this.colors.accent, beside ? 9 : 6);
    let count = 0;
    for (const object of objects) {
      if (count >= kMostLabels) break;
      if (this.put(pen, camera, width, height, middleOf(object), isolated(shortName(object.name)), this.colors.ink, 8)) ++count;
    }
  }

  /// Writes a text where there is no other; returns whether there was room.
  put(pen, camera, width, height, point, text, color, away) {
    const seen = camera.project(point);
    if (!seen) return false;
    const x = (seen[0] + 1) * 0.5 * width + away;
    const y = (1 - seen[1]) * 0.5 * height;
    const wide = pen.measureText(text).width;
    const box = [x - 3, y - 8, x + wide + 3, y + 8];
    if (box[0] < 0 || box[1] < 0 || box[2] > width || box[3] > height) return false;
    if (this.placed.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])) return false;
    this.placed.push([...box, text]);
    pen.globalAlpha = 0.82;
    pen.fillStyle = this.colors.paper;
    pen.fillRect(box[0], box[1], box[2] - box[0], box[3] - box[1]);
    pen.globalAlpha = 1;
    pen.fillStyle = color;
    pen.fillText(text, x, y);
    return true;
  }
}

const middleOf = (object) => (object.own.isEmpty() ? object.position : add(object.position, rotate(object.turn, object.own.center())));
