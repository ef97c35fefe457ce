// First pass, for round or small primitives: rays are cast inside a cover. Large ones are covered by the box around
// them, seen from behind, so that an eye inside sees them too; small ones by a point, a square of pixels, which costs a
// twelfth of the triangles: without a graphics card triangles, not pixels, are the cost of ten thousand small ones.

// The width of a point that covers a primitive of this radius. The image of a ball is an ellipse, which reaches
// farthest away from the middle of the picture; 2 more pixels are for rounding.
const kPointSize = `
uniform float u_focal;  // pixels to 1 m at a distance of 1 m
float point_size(vec3 center, float depth, float reach) {
  float away = dot(center, center);
  float across = sqrt(max(away - depth * depth, 0.0)) / depth;
  float wide = reach / sqrt(away - reach * reach);
  return 2.0 * u_focal * wide * (1.0 + across * across) / (1.0 - across * wide) + 2.0;
}
`;

// The ray of a pixel: its component along the view is 1.
const kRay = `
uniform vec2 u_seen_size;
uniform vec3 u_forward;
uniform vec3 u_half_right;
uniform vec3 u_half_up;
uniform vec2 u_depth_range;  // near, far
vec3 ray_here() {
  vec2 at = 2.0 * gl_FragCoord.xy / u_seen_size - 1.0;
  return u_forward + at.x * u_half_right + at.y * u_half_up;
}
float depth_of(float depth) {
  float n = u_depth_range.x;
  float f = u_depth_range.y;
  return clamp(0.5 + 0.5 * ((f + n) / (f - n) - 2.0 * f * n / ((f - n) * depth)), 0.0, 1.0);
}
`;

const kBallPointVertex = `#version 300 es
precision highp float;
${kSolidInstance}${kStates}${kPointSize}
flat out vec4 v_ball;  // middle from the eye, radius
flat out vec2 v_slot_farther;
void main() {
  v_ball = vec4(i_position + u_anchor_from_eye, i_half.x);
  uint state = state_of(uint(i_kind_slot.y));
  v_slot_farther = vec2(i_kind_slot.y, farther_of(state));
  gl_Position = placed_at(u_matrix * vec4(v_ball.xyz, 1.0), state & 255u, 0.0);
  gl_PointSize = point_size(v_ball.xyz, gl_Position.w, v_ball.w);
}`;

const kBallPointFragment = `${kSeenOutput}${kRay}
flat in vec4 v_ball;
flat in vec2 v_slot_farther;
void main() {
  vec3 ray = ray_here();
  float whole = length(ray);
  vec3 d = ray / whole;
  float nearest = dot(v_ball.xyz, d);
  vec3 beside = v_ball.xyz - nearest * d;
  float reach = v_ball.w * v_ball.w - dot(beside, beside);
  if (reach < 0.0) discard;
  float h = sqrt(reach);
  gl_FragDepth = depth_of((nearest - h) / whole * v_slot_farther.y);
  write_seen(uint(v_slot_farther.x), nearest - h, (-beside - h * d) / v_ball.w, -d, 1u);
}`;

const kRoundVaryings = (way) => `
flat ${way} vec3 v_eye;
flat ${way} vec3 v_half;
flat ${way} vec4 v_turn;
flat ${way} vec3 v_kind_slot_farther;
`;

const kRoundTold = `${kRoundVaryings("out")}
void tell_fragments(vec3 center) {
  v_eye = turned_back(i_turn, -center);
  v_half = i_half;
  v_turn = i_turn;
  v_kind_slot_farther = vec3(i_kind_slot, farther_of(state_of(uint(i_kind_slot.y))));
}
`;

const kRoundPointVertex = `#version 300 es
precision highp float;
${kSolidInstance}${kTurn}${kStates}${kPointSize}${kRoundTold}
void main() {
  vec3 center = i_position + u_anchor_from_eye;
  tell_fragments(center);
  gl_Position = placed_at(u_matrix * vec4(center, 1.0), state_of(uint(i_kind_slot.y)) & 255u, 0.0);
  gl_PointSize = point_size(center, gl_Position.w, length(i_half));
}`;

const kBoxPointFragment = `${kSeenOutput}${kRay}${kRoundVaryings("in")}${kTurn}
void main() {
  vec3 ray = ray_here();
  float whole = length(ray);
  vec3 d = turned_back(v_turn, ray / whole);
  // Where the ray enters the slabs between opposite sides, and leaves them.
  vec3 a = (-v_half - v_eye) / d;
  vec3 b = (v_half - v_eye) / d;
  vec3 enter = min(a, b);
  vec3 leave = max(a, b);
  float range = max(max(enter.x, enter.y), enter.z);
  if (range > min(min(leave.x, leave.y), leave.z)) discard;
  int axis = range == enter.x ? 0 : range == enter.y ? 1 : 2;
  vec3 normal = vec3(0.0);
  normal[axis] = d[axis] > 0.0 ? -1.0 : 1.0;
  gl_FragDepth = depth_of(range / whole * v_kind_slot_farther.z);
  write_seen(uint(v_kind_slot_farther.y), range, turned(v_turn, normal), -ray / whole, uint(2 * axis + (d[axis] > 0.0 ? 1 : 2)));
}`;

const kRoundBoxVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec4 a_corner;  // and the side of the triangle that ends here
${kSolidInstance}${kTurn}${kStates}${kRoundTold}
void main() {
  vec3 center = i_position + u_anchor_from_eye;
  tell_fragments(center);
  vec3 corner = a_corner.xyz * i_half * 1.001;
  gl_Position = placed_at(u_matrix * vec4(turned(i_turn, corner) + center, 1.0), state_of(uint(i_kind_slot.y)) & 255u, 0.0);
}`;

const kRoundFragment = `${kSeenOutput}${kRay}${kRoundVaryings("in")}${kTurn}
const float kNone = 1e30;
vec3 g_normal;
uint g_side = 1u;

// Each takes the nearest of its hits ahead of 'from'; origin o, unit direction d.
void keep(float t, float from, vec3 normal, inout float best) {
  if (t > from && t < best) { best = t; g_normal = normal; }
}
float ball(vec3 o, vec3 d, float radius, float from) {
  float b = dot(o, d);
  float reach = radius * radius - dot(o - b * d, o - b * d);
  if (reach < 0.0) return kNone;
  float h = sqrt(reach);
  float best = kNone;
  keep(-b - h, from, (o + (-b - h) * d) / radius, best);
  keep(-b + h, from, (o + (-b + h) * d) / radius, best);
  return best;
}
// A tube about z whose radius is r at z = -h and shrinks by k a metre: cylinder and cone.
float tube(vec3 o, vec3 d, float r, float k, float h, float from) {
  float best = kNone;
  float wide = r - k * (o.z + h);
  float a = dot(d.xy, d.xy) - k * k * d.z * d.z;
  float b = dot(o.xy, d.xy) + k * wide * d.z;
  float c = dot(o.xy, o.xy) - wide * wide;
  float root = b * b - a * c;
  if (root >= 0.0 && abs(a) > 1e-12) {
    root = sqrt(root);
    for (int side = -1; side <= 1; side += 2) {
      float t = (-b + float(side) * root) / a;
      vec3 p = o + t * d;
      if (abs(p.z) <= h) keep(t, from, normalize(vec3(p.xy, k * (r - k * (p.z + h)))), best);
    }
  }
  for (int end = -1; end <= 1; end += 2) {
    float t = (float(end) * h - o.z) / d.z;
    vec3 p = o + t * d;
    float cap = end < 0 ? r : r - 2.0 * k * h;
    if (dot(p.xy, p.xy) > cap * cap) continue;
    float before = best;
    keep(t, from, vec3(0.0, 0.0, float(end)), best);
    if (best < before) g_side = uint(2 + end);
  }
  return best;
}
float pill(vec3 o, vec3 d, float r, float h, float from) {
  float best = kNone;
  float a = dot(d.xy, d.xy);
  float b = dot(o.xy, d.xy);
  float root = b * b - a * (dot(o.xy, o.xy) - r * r);
  if (root >= 0.0 && a > 1e-12) {
    root = sqrt(root);
    for (int side = -1; side <= 1; side += 2) {
      float t = (-b + float(side) * root) / a;
      vec3 p = o + t * d;
      if (abs(p.z) <= h) keep(t, from, vec3(p.xy / r, 0.0), best);
    }
  }
  for (int end = -1; end <= 1; end += 2) {
    vec3 normal = g_normal;
    float t = ball(o - vec3(0.0, 0.0, float(end) * h), d, r, from);
    vec3 found = g_normal;
    g_normal = normal;
    if (t < kNone && (o.z + t * d.z) * float(end) >= h) keep(t, from, found, best);
  }
  return best;
}

void main() {
  vec3 ray = ray_here();
  float whole = length(ray);
  vec3 d = turned_back(v_turn, ray / whole);
  // From the place nearest to the middle, where numbers are small.
  float shift = -dot(v_eye, d);
  vec3 o = v_eye + shift * d;
  int kind = int(v_kind_slot_farther.x);
  float t = kNone;
  if (kind == 0) {
    t = ball(o, d, v_half.x, -shift);
  } else if (kind == 2) {
    t = pill(o, d, v_half.x, v_half.z - v_half.x, -shift);
  } else if (kind == 5) {
    vec3 e = d / v_half;
    float stretch = length(e);
    t = ball(o / v_half, e / stretch, 1.0, -shift * stretch) / stretch;
    if (t < kNone / stretch) g_normal = normalize(g_normal / v_half); else t = kNone;
  } else {
    t = tube(o, d, v_half.x, kind == 4 ? v_half.x / (2.0 * v_half.z) : 0.0, v_half.z, -shift);
  }
  if (t >= kNone) discard;
  float range = t + shift;
  gl_FragDepth = depth_of(range / whole * v_kind_slot_farther.z);
  write_seen(uint(v_kind_slot_farther.y), range, turned(v_turn, g_normal), -turned(v_turn, d), g_side + uint(kind) * 8u);
}`;
