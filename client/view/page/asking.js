/// The page's questions to the server, and how it shows the answers: to clicks and drags, and distances to the object
/// under the pointer.
class Asking {
  /// on: {send(question) -> whether it was sent, whyNotSent(), chosen(), hovered(), choose(slot), drawn()}
  constructor(world, camera, marks, on) {
    this.world = world;
    this.camera = camera;
    this.marks = marks;
    this.on = on;
    this.question = 0;
    this.connection = "";
    this.gap = null;
    byId("copy").addEventListener("click", () => this.copy());
    byId("close-answer").addEventListener("click", () => this.hideAnswer());
  }

  /// Sends a question with a new number; returns that, or null if it cannot be sent.
  ask(question) {
    const id = ++this.question;
    return this.on.send({ ...question, id }) ? id : null;
  }

  /// Asks the user's question; the answer is shown with the command that gives it.
  askShown(question) {
    this.clicked = this.ask(question);
    this.shown = { question, at: performance.now() };
    if (this.clicked === null) this.showAnswer([this.on.whyNotSent()], "", "");
  }

  /// Asks a ray from the eye. The command line shows the numbers as sent: all their digits.
  ray(x, y) {
    const digits = Math.min(9, Math.max(0, 5 - Math.floor(Math.log10(this.camera.distance))));
    const origin = this.camera.eye().map((part) => Number(part.toFixed(digits)));
    const direction = this.camera.direction(x, y).map((part) => Number(part.toFixed(6)));
    this.askShown({ ask: "ray", origin, direction });
  }

  /// Asks for the distance from the chosen object to the one under the pointer. One question at a time.
  askGap() {
    const [a, b] = [this.on.chosen(), this.on.hovered()];
    if (!a || !b || a === b || this.isAskingGap) return;
    this.isAskingGap = true;
    setTimeout(() => { this.isAskingGap = false; }, 250);
    this.ask({ ask: "pair", a: a.name, b: b.name });
  }
  forgetGap() {
    this.gap = null;
    this.marks.line = null;
  }

  hear(answer) {
    if (answer.ask === "ray") this.drawRay(answer);
    if (answer.id === this.clicked) this.showClicked(answer);
    else if (answer.ask === "pair") this.showGap(answer);
  }
  refused({ id, why }) {
    if (id === this.clicked) this.showAnswer([why], "", commandText(this.connection, this.shown.question));
  }

  drawRay(answer) {
    const unit = normalized(answer.direction);
    const met = answer.answer === "hit";
    const to = met ? answer.point : add(answer.origin, scale(unit, this.camera.distance * 3));
    // It is drawn from slightly beside the eye, since a line from the eye itself would look like a point.
    const { up, right } = this.camera.axes();
    const from = add(answer.origin, scale(subtract(scale(right, 0.25), up), this.camera.distance * 0.2));
    this.marks.rays.push({ from, to, met, normal: answer.normal || unit, at: performance.now() });
    this.marks.rays = this.marks.rays.slice(-50);
    this.on.drawn();
  }

  showClicked(answer) {
    this.lastAnswer = answer;
    const { question, at } = this.shown;
    if (answer.ask === "ray") this.on.choose(answer.answer === "hit" ? this.world.byName.get(answer.object)?.slot ?? null : null);
    this.marks.asked = answerPieces(question, answer);
    this.showAnswer(answerParts(question, answer), costText(answer, performance.now() - at), commandText(this.connection, question));
    this.on.drawn();
  }

  showAnswer(parts, cost, command, isHidden = false) {
    byId("answer-text").replaceChildren(...parts);
    setText(byId("answer-cost"), cost);
    byId("answer-command").textContent = command;
    byId("copy").hidden = !command;
    byId("answer").hidden = isHidden;
  }
  hideAnswer() {
    byId("answer").hidden = true;
    this.marks.asked = null;
    this.on.drawn();
  }

  async copy() {
    const text = byId("answer-command").textContent;
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // Only pages of https and of this machine may copy; otherwise the command is selected.
      getSelection().selectAllChildren(byId("answer-command"));
      return;
    }
    byId("copy").textContent = "copied";
    setTimeout(() => { byId("copy").textContent = "copy"; }, 1500);
  }

  showGap(answer) {
    const [a, b] = [this.on.chosen(), this.on.hovered()];
    if (answer.a !== a?.name || answer.b !== b?.name) return this.askGap();
    this.marks.line = null;
    if (answer.answer === "miss") {
      this.gap = `${lengthText(answer.distance)} from the chosen one`;
      if (answer.on_a && answer.on_b) this.marks.line = { from: answer.on_a, to: answer.on_b, text: lengthText(answer.distance) };
    } else if (answer.answer === "hit") {
      const depth = depthText(answer);
      this.gap = depth === "touching" ? "touches the chosen one" : `${depth} deep in the chosen one`;
      // They overlap as shapes, but that is not a contact.
      if (!mayMeet(a, b)) this.gap = "overlaps the chosen one; the two never meet (layers, groups, or neither moves)";
    } else this.gap = "undecided against the chosen one";
    this.on.drawn();
  }
}
