// Second pass: paper and ink from the results of the first pass (shaders_seen.js); marks over it.

const kWholeVertex = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0.8, 1.0); }`;

// Drawing without a graphics card works through every branch of a shader in every pixel, so this one has few and short
// ones.
const kInkFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
uniform usampler2D u_seen;
uniform usampler2D u_states;
uniform sampler2D u_tints;    // by slot: color, and how much of it
uniform vec2 u_size;          // of the picture
uniform vec2 u_seen_size;     // of the first pass, which may be coarser
uniform float u_pixels;       // to one of the screen
uniform float u_pixel_angle;  // between two places of the first pass, seen from the eye
uniform vec3 u_paper;
uniform vec3 u_ink;
uniform vec3 u_accent;
uniform vec3 u_light;
out vec4 o_color;

// Normal, and how much it faces the eye.
vec4 facing_of(uvec4 seen) { return vec4(ivec4(seen.zzzz << uvec4(24u, 16u, 8u, 0u)) >> 24) / 127.0; }

// How strong the line between two places is: 1 for an outline, less for a crease, 0 for none.
float line_between(uvec4 a, uvec4 b, vec4 facing_a, vec4 facing_b) {
  float range = uintBitsToFloat(a.y);
  // Where a plane is seen at a flat angle, its range changes much from place to place.
  float most = range * (0.04 + 3.0 * u_pixel_angle / max(min(facing_a.w, facing_b.w), 0.01));
  bool is_jump = abs(uintBitsToFloat(b.y) - range) > most;
  float within = dot(facing_a.xyz, facing_b.xyz) < 0.8 ? 0.6 : is_jump ? 0.8 : 0.0;
  return a.x != b.x ? 1.0 : a.w != b.w ? 0.6 : a.w == 0u && a.x != 0u ? within : 0.0;
}

uvec4 nearer(uvec4 a, uvec4 b) {
  return b.x != 0u && (a.x == 0u || uintBitsToFloat(b.y) < uintBitsToFloat(a.y)) ? b : a;
}

vec3 tone_of(uint slot, vec3 normal, uint state) {
  vec4 tint = texelFetch(u_tints, ivec2(slot % 1024u, slot / 1024u), 0);
  float light = dot(normal, u_light);
  float tone = light > 0.45 ? 0.0 : light > -0.15 ? 0.05 : 0.11;
  bool is_faint = (state & 128u) != 0u;
  vec3 color = mix(u_paper, u_ink, is_faint ? tone * 0.3 : tone + ((state & 1u) != 0u ? 0.10 : 0.025));
  vec2 at = gl_FragCoord.xy / u_pixels;
  float stripe = fract((at.x + at.y) / 7.0);
  float other_stripe = fract((at.x - at.y) / 9.0);
  float accent = ((state & 2u) != 0u ? 0.30 : 0.0) + ((state & 4u) != 0u ? 0.08 : 0.0) + ((state & 8u) != 0u ? 0.20 : 0.0);
  accent = (state & 64u) != 0u && other_stripe < 0.3 ? 0.6 : accent;
  float ink = (state & 16u) != 0u && stripe < 0.25 ? 0.45 : 0.0;
  return is_faint ? color : mix(mix(mix(color, tint.rgb, tint.a), u_accent, accent), u_ink, ink);
}

// The four places of the first pass around a pixel are weighed by how near they are; those that belong together with most
// of the weight are what is seen, and the line runs where that is half. So lines are thin and smooth though the first
// pass be coarse. a to d: lower left, lower right, upper left, upper right.
void main() {
  vec2 scale = u_seen_size / u_size;
  vec2 t = gl_FragCoord.xy * scale - 0.5 + 0.5 * scale;
  ivec2 base = ivec2(floor(t));
  vec2 f = t - vec2(base);
  ivec2 last = ivec2(u_seen_size) - 1;
  ivec2 low = max(base, ivec2(0));
  ivec2 high = min(base + 1, last);
  uvec4 a = texelFetch(u_seen, low, 0);
  uvec4 b = texelFetch(u_seen, ivec2(high.x, low.y), 0);
  uvec4 c = texelFetch(u_seen, ivec2(low.x, high.y), 0);
  uvec4 d = texelFetch(u_seen, high, 0);
  vec4 facing_a = facing_of(a);
  vec4 facing_b = facing_of(b);
  vec4 facing_c = facing_of(c);
  vec4 facing_d = facing_of(d);
  float ab = line_between(a, b, facing_a, facing_b);
  float cd = line_between(c, d, facing_c, facing_d);
  float ac = line_between(a, c, facing_a, facing_c);
  float bd = line_between(b, d, facing_b, facing_d);
  vec4 weight = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
  bool is_ad = ab + bd == 0.0 || ac + cd == 0.0;
  bool is_bc = ab + ac == 0.0 || bd + cd == 0.0;
  vec4 together = weight + vec4(ab == 0.0 ? weight.y : 0.0, ab == 0.0 ? weight.x : 0.0, cd == 0.0 ? weight.w : 0.0, cd == 0.0 ? weight.z : 0.0) +
    vec4(ac == 0.0 ? weight.z : 0.0, bd == 0.0 ? weight.w : 0.0, ac == 0.0 ? weight.x : 0.0, bd == 0.0 ? weight.y : 0.0) +
    vec4(is_ad ? weight.w : 0.0, is_bc ? weight.z : 0.0, is_bc ? weight.y : 0.0, is_ad ? weight.x : 0.0);
  float most = max(max(together.x, together.y), max(together.z, together.w));
  uvec4 here = together.x == most ? a : together.y == most ? b : together.z == most ? c : d;
  vec4 facing = together.x == most ? facing_a : together.y == most ? facing_b : together.z == most ? facing_c : facing_d;
  float strength = max(max(ab, cd), max(ac, bd));
  float line = strength * clamp(0.5 * u_pixels + 0.5 - (most - 0.5) / max(scale.x, scale.y), 0.0, 1.0);
  uint slot = max(here.x, 1u) - 1u;
  uint state = texelFetch(u_states, ivec2(slot % 1024u, slot / 1024u), 0).r;
  vec3 color = here.x == 0u ? u_paper : tone_of(slot, facing.xyz, state);
  // The line belongs to the nearest of what meets here.
  uint owner = max(nearer(nearer(a, b), nearer(c, d)).x, 1u) - 1u;
  uint line_state = texelFetch(u_states, ivec2(owner % 1024u, owner / 1024u), 0).r;
  line *= (line_state & 128u) != 0u ? 0.25 : 0.9;
  o_color = vec4(mix(color, (line_state & 8u) != 0u ? u_accent : u_ink, line), 1.0);
  // The grid on the ground is drawn over the background only.
  gl_FragDepth = here.x == 0u && line == 0.0 ? 0.5 : 0.25;
}`;

// Lines, rings and dots over the picture; behind something they are paler and dashed, as in a technical drawing. The
// grid on the ground is lines too, fainter with distance.
const kMarkVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec2 a_corner;   // -1 to 1 across and along
layout(location = 1) in vec3 i_from;
layout(location = 2) in vec3 i_to;
layout(location = 3) in vec4 i_look;     // width (px), kind (0 line, 1 ring, 2 dot, 3 grid), strength, accent (grid: how far it reaches)
uniform mat4 u_matrix;
uniform vec3 u_anchor_from_eye;
uniform vec2 u_size;
uniform float u_pixels;  // to one of the screen
out vec2 v_place;
out vec3 v_point;
flat out vec4 v_look;
flat out float v_pixels;
void main() {
  vec3 from = i_from + u_anchor_from_eye;
  vec3 to = i_to + u_anchor_from_eye;
  vec4 a = u_matrix * vec4(from, 1.0);
  vec4 b = u_matrix * vec4(to, 1.0);
  const float kNear = 1e-4;
  if (a.w < kNear && b.w < kNear) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  if (a.w < kNear) { float t = (kNear - a.w) / (b.w - a.w); a = mix(a, b, t); from = mix(from, to, t); }
  if (b.w < kNear) { float t = (kNear - b.w) / (a.w - b.w); b = mix(b, a, t); to = mix(to, from, t); }
  vec2 along = (b.xy / b.w - a.xy / a.w) * u_size * 0.5;
  v_pixels = length(along);
  along = v_pixels > 1e-3 ? along / v_pixels : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  bool line = i_look.y < 0.5 || i_look.y > 2.5;
  float end = a_corner.y * 0.5 + 0.5;
  vec4 p = line && end > 0.5 ? b : a;
  float reach = i_look.x * u_pixels * 0.5 + 1.0;
  vec2 offset = a_corner.x * across * reach + a_corner.y * along * (line ? 1.0 : reach);
  v_place = vec2(a_corner.x * reach, line ? end * v_pixels : a_corner.y * reach);
  v_point = line ? mix(from, to, end) : from;
  v_look = vec4(i_look.x * u_pixels, i_look.yzw);
  gl_Position = vec4(p.xy + offset / (u_size * 0.5) * p.w, -0.2 * p.w, p.w);
}`;

const kMarkFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
uniform usampler2D u_seen;
uniform vec2 u_seen_scale;  // of its size to the picture's
uniform vec3 u_ink;
uniform vec3 u_accent;
uniform float u_pixels;
in vec2 v_place;
in vec3 v_point;
flat in vec4 v_look;
flat in float v_pixels;
out vec4 o_color;
void main() {
  uvec4 seen = texelFetch(u_seen, ivec2(gl_FragCoord.xy * u_seen_scale), 0);
  bool hidden = seen.x != 0u && uintBitsToFloat(seen.y) < length(v_point) * 0.998;
  float half_width = v_look.x * 0.5;
  float strength = v_look.z;
  float accent = v_look.w;
  float cover;
  if (v_look.y > 2.5) {
    cover = clamp(half_width + 0.5 - abs(v_place.x), 0.0, 1.0);
    strength *= clamp(1.0 - length(v_point) / accent, 0.0, 1.0);
    accent = 0.0;
  } else if (v_look.y < 0.5) {
    cover = clamp(half_width + 0.5 - abs(v_place.x), 0.0, 1.0);
    if (hidden && fract(v_place.y / (6.0 * u_pixels)) > 0.5) cover = 0.0;
  } else if (v_look.y < 1.5) {
    cover = clamp(0.75 * u_pixels + 0.5 - abs(length(v_place) - half_width + u_pixels), 0.0, 1.0);
  } else {
    cover = clamp(half_width + 0.5 - length(v_place), 0.0, 1.0);
  }
  float alpha = cover * strength * (hidden ? 0.4 : 1.0);
  if (alpha <= 0.0) discard;
  o_color = vec4(mix(u_ink, u_accent, accent) * alpha, alpha);
}`;
