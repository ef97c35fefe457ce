// Sources of the world that the page shows: the viewer that served it, or a run.

function readSurface(bytes) {
  const view = new DataView(bytes);
  const vertices = view.getUint32(0, true);
  const triangles = view.getUint32(4, true);
  const origin = [8, 16, 24].map((at) => view.getFloat64(at, true));
  const positions = new Float32Array(bytes, 32, 3 * vertices);
  const corners = new Uint32Array(bytes, 32 + 12 * vertices, 3 * triangles);
  // boundsOf: bounds of runs, by "first count"; most surfaces hold many objects.
  return { origin, positions, corners, boundsOf: new Map() };
}

/// The bounds of some triangles of a surface, in the frame of its objects.
function boundsOfRun(surface, first, count) {
  const key = `${first} ${count}`;
  if (!surface.boundsOf.has(key)) {
    const { origin, positions, corners } = surface;
    const own = new Bounds();
    for (let i = 3 * first; i < 3 * (first + count); ++i) {
      for (let axis = 0; axis < 3; ++axis) {
        const value = positions[3 * corners[i] + axis];
        if (value < own.low[axis]) own.low[axis] = value;
        if (value > own.high[axis]) own.high[axis] = value;
      }
    }
    own.low = add(own.low, origin);
    own.high = add(own.high, origin);
    surface.boundsOf.set(key, own);
  }
  return surface.boundsOf.get(key);
}

function readPoses(bytes) {
  const view = new DataView(bytes);
  const count = view.getUint32(4, true);
  return {
    count,
    worldTime: view.getFloat64(8, true),
    tableVersion: view.getFloat64(16, true),
    version: view.getFloat64(24, true),
    origin: [32, 40, 48].map((at) => view.getFloat64(at, true)),
    numbers: new Float32Array(bytes, 56, 7 * count),
    slots: new Uint32Array(bytes, 56 + 28 * count, count),
    stale: new Uint8Array(bytes, 56 + 32 * count, count),
  };
}

/// Surfaces by number. Each is fetched once and kept for as long as the newest table has it.
class Surfaces {
  constructor(fetchOne) {
    this.fetchOne = fetchOne;
    this.known = new Map();
  }
  async all(table) {
    const wanted = new Set(table.objects.flatMap((object) => object.runs.map(([number]) => number)));
    const key = (number) => `${table.epoch} ${number}`;
    const kept = new Map();
    for (const number of wanted) {
      let surface = this.known.get(key(number));
      if (!surface) {
        const bytes = await this.fetchOne(number, table.epoch);
        if (bytes) surface = readSurface(bytes);
      }
      if (surface) kept.set(key(number), surface);
    }
    this.known = kept;
    return { of: (number) => kept.get(key(number)), missing: wanted.size - kept.size };
  }
}

/// tell(kind, value): "table" {table, surfaceOf}, "poses" (readPoses), "connected" (bool), or a message by its type.
class LiveSource {
  constructor(tell) {
    this.tell = tell;
    this.surfaces = new Surfaces(async (number) => {
      const reply = await fetch(`surface?number=${number}`);
      return reply.ok ? reply.arrayBuffer() : null;
    });
    this.pause = 250;
    this.connect();
    setInterval(() => this.lookForSilence(), 1000);
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/live`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.pause = 250;
      this.silentLooks = 0;
      this.tell("connected", true);
    };
    socket.onmessage = (message) => this.hear(message.data);
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.tell("connected", false);
      setTimeout(() => this.connect(), this.pause);
      this.pause = Math.min(2000, this.pause * 2);
    };
  }

  /// The viewer sends something twice a second; a connection without data for five looks, one a second, is closed. The
  /// clock would not do: a page that was busy for that long still has unread messages.
  lookForSilence() {
    if (this.socket.readyState !== WebSocket.OPEN || ++this.silentLooks < 5) return;
    const silent = this.socket;
    silent.close();
    silent.onclose();
    silent.onclose = null;
  }

  hear(data) {
    this.silentLooks = 0;
    if (typeof data !== "string") {
      this.tell("poses", readPoses(data));
      return;
    }
    const message = JSON.parse(data);
    if (message.type === "table") this.fetchTable(message);
    else this.tell(message.type, message);
  }

  /// Fetches one table at a time; the newest one announced is fetched last.
  async fetchTable(wanted) {
    this.wanted = wanted;
    if (this.isFetching) return;
    this.isFetching = true;
    try {
      while (this.wanted) {
        this.wanted = null;
        const reply = await fetch("objects");
        if (!reply.ok) continue;
        const table = await reply.json();
        const surfaces = await this.surfaces.all(table);
        this.tell("table", { table, surfaceOf: surfaces.of });
        // The world has changed meanwhile, and the surfaces of this table no longer exist.
        if (surfaces.missing > 0) setTimeout(() => this.fetchTable(wanted), 500);
      }
    } catch (failed) {
      setTimeout(() => this.fetchTable(wanted), 500);
    } finally {
      this.isFetching = false;
    }
  }

  /// Why questions cannot be sent; empty if they can.
  whyGone() { return this.socket.readyState === WebSocket.OPEN ? "" : "the viewer is gone: the server was not asked"; }
  /// Returns whether it was sent.
  ask(question) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(question));
    return true;
  }
}

/// A run that `collide view --save` wrote into this file, or that the viewer made of a recording
/// (client/view/run_writer.hpp). It is passed on once as a whole, each message with its time.
class SavedSource {
  /// keep(t, kind, value): t in seconds from the beginning
  constructor(run, keep) {
    this.run = run;
    this.keep = keep;
    this.surfaces = new Surfaces(async (number, epoch) => {
      const packed = run.surfaces[`${epoch} ${number}`];
      return packed ? unpacked(packed) : null;
    });
  }
  duration() { return this.run.end - this.run.begin; }

  async unpack() {
    for (const { t, kind, data } of this.run.messages) {
      const at = t - this.run.begin;
      if (kind === "poses") this.keep(at, "poses", readPoses(await unpacked(data)));
      else if (kind === "objects") {
        const table = JSON.parse(new TextDecoder().decode(await unpacked(data)));
        this.keep(at, "table", { table, surfaceOf: (await this.surfaces.all(table)).of });
      } else {
        const message = JSON.parse(data);
        this.keep(at, message.type, message);
      }
    }
  }

  whyGone() { return "this page is a saved run: it has no server to ask"; }
  ask() { return false; }
}

async function unpacked(base64) {
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
}
