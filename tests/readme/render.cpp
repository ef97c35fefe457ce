// Renders what a running server holds to a PNG, by nothing but the service's own rays: paper, ink lines where depth or
// normal jumps, soft shade by the angle to a lamp. The README's picture is made by it.
// usage: render OUT.png EYE(x y z) TARGET(x y z) [--up y|z] [--size W H] [--fov DEGREES] [--domain N] [--namespace NAME]
#include <zlib.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <collided/client.hpp>

namespace {

using collided::Vec3;

struct View {
  Vec3 eye, target, up = {0, 0, 1};
  int width = 960;
  int height = 540;
  double fov_rad = 0.9;
  collided::ConnectOptions connect;
  std::string out;
};

struct Pixel {
  double depth_m = 0;  // infinite on a miss
  Vec3 normal = Vec3::Zero();
  bool moving = false;
};

View parse(int count, char** words) {
  View view;
  view.out = words[1];
  for (int k = 0; k < 3; ++k) view.eye[k] = std::atof(words[2 + k]);
  for (int k = 0; k < 3; ++k) view.target[k] = std::atof(words[5 + k]);
  for (int i = 8; i + 1 < count; ++i) {
    const std::string word = words[i];
    if (word == "--up" && *words[i + 1] == 'y') view.up = {0, 1, 0};
    if (word == "--size" && i + 2 < count) {
      view.width = std::atoi(words[i + 1]);
      view.height = std::atoi(words[i + 2]);
    }
    if (word == "--fov") view.fov_rad = std::atof(words[i + 1]) * M_PI / 180;
    if (word == "--domain") view.connect.domain = std::atoi(words[i + 1]);
    if (word == "--namespace") view.connect.name_space = words[i + 1];
  }
  return view;
}

std::vector<collided::RayQuestion> camera_rays(const View& view) {
  const Vec3 forward = (view.target - view.eye).normalized();
  const Vec3 right = forward.cross(view.up).normalized();
  const Vec3 above = right.cross(forward);
  const double half = std::tan(view.fov_rad / 2);
  std::vector<collided::RayQuestion> rays;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const double u = (2 * (x + 0.5) / view.width - 1) * half * view.width / view.height;
      const double v = (1 - 2 * (y + 0.5) / view.height) * half;
      rays.push_back({.origin = view.eye, .direction = (forward + u * right + v * above).normalized()});
    }
  }
  return rays;
}

std::vector<Pixel> cast(collided::Client& client, const std::vector<collided::RayQuestion>& rays) {
  std::vector<Pixel> pixels;
  constexpr std::size_t kRequest = 100'000;
  for (std::size_t first = 0; first < rays.size(); first += kRequest) {
    const std::size_t count = std::min(kRequest, rays.size() - first);
    const auto answers = client.ask(std::span(rays).subspan(first, count));
    if (!answers) {
      std::fprintf(stderr, "render: %s\n", answers.error().message.c_str());
      std::exit(1);
    }
    for (const collided::Answer& answer : answers->answers) {
      Pixel pixel{.depth_m = INFINITY};
      if (answer.verdict == collided::Verdict::hit) {
        pixel.depth_m = answer.hits[0].distance_m;
        pixel.normal = answer.hits[0].normal;
        pixel.moving = answer.hits[0].triangle == collided::kNoTriangle;
      }
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

/// A line runs where a neighbour is much farther or faces another way.
bool is_edge(const Pixel& a, const Pixel& b) {
  if (std::isinf(a.depth_m) != std::isinf(b.depth_m)) return true;
  if (std::isinf(a.depth_m)) return false;
  return std::abs(a.depth_m - b.depth_m) > 0.02 * std::min(a.depth_m, b.depth_m) || a.normal.dot(b.normal) < 0.85;
}

std::vector<unsigned char> shade(const View& view, const std::vector<Pixel>& pixels) {
  const Vec3 lamp = (0.5 * view.up + Vec3(0.3, 0.4, 0.2)).normalized();
  std::vector<unsigned char> image;
  const Vec3 paper(250, 247, 240), ink(38, 44, 58), accent(196, 72, 48);
  for (int y = 0; y < view.height; ++y) {
    image.push_back(0);  // PNG: this row is not filtered
    for (int x = 0; x < view.width; ++x) {
      const Pixel& pixel = pixels[static_cast<std::size_t>(y) * view.width + x];
      const Pixel& right = x + 1 < view.width ? pixels[static_cast<std::size_t>(y) * view.width + x + 1] : pixel;
      const Pixel& below = y + 1 < view.height ? pixels[static_cast<std::size_t>(y + 1) * view.width + x] : pixel;
      Vec3 colour = paper;
      if (!std::isinf(pixel.depth_m)) {
        const double light = 0.62 + 0.38 * std::max(0.0, pixel.normal.dot(lamp));
        colour = light * (pixel.moving ? Vec3(0.35 * paper + 0.65 * accent) : paper);
      }
      if (is_edge(pixel, right) || is_edge(pixel, below)) colour = ink;
      for (int k = 0; k < 3; ++k) image.push_back(static_cast<unsigned char>(std::lround(colour[k])));
    }
  }
  return image;
}

void put_chunk(std::ofstream& file, const char* kind, const std::vector<unsigned char>& data) {
  std::vector<unsigned char> body(kind, kind + 4);
  body.insert(body.end(), data.begin(), data.end());
  const auto put_32 = [&](unsigned long n) {
    for (int shift = 24; shift >= 0; shift -= 8) file.put(static_cast<char>((n >> shift) & 0xff));
  };
  put_32(data.size());
  file.write(reinterpret_cast<const char*>(body.data()), static_cast<std::streamsize>(body.size()));
  put_32(crc32(0, body.data(), static_cast<unsigned>(body.size())));
}

bool write_png(const View& view, const std::vector<unsigned char>& image) {
  std::ofstream file(view.out, std::ios::binary);
  file.write("\x89PNG\r\n\x1a\n", 8);
  std::vector<unsigned char> header(13, 0);
  for (int k = 0; k < 4; ++k) {
    header[k] = static_cast<unsigned char>(view.width >> (24 - 8 * k));
    header[4 + k] = static_cast<unsigned char>(view.height >> (24 - 8 * k));
  }
  header[8] = 8;  // bits a channel
  header[9] = 2;  // RGB
  put_chunk(file, "IHDR", header);
  uLongf size = compressBound(image.size());
  std::vector<unsigned char> packed(size);
  compress2(packed.data(), &size, image.data(), image.size(), 9);
  packed.resize(size);
  put_chunk(file, "IDAT", packed);
  put_chunk(file, "IEND", {});
  return file.good();
}

}  // namespace

int main(int count, char** words) {
  if (count < 8) {
    std::fprintf(stderr, "usage: render OUT.png EX EY EZ TX TY TZ [--up y] [--size W H] [--fov DEG] [--domain N]\n");
    return 2;
  }
  const View view = parse(count, words);
  auto client = collided::Client::connect(view.connect);
  if (!client) {
    std::fprintf(stderr, "render: %s\n", client.error().message.c_str());
    return 4;
  }
  const std::vector<Pixel> pixels = cast(*client, camera_rays(view));
  std::size_t hits = 0;
  for (const Pixel& pixel : pixels) hits += std::isinf(pixel.depth_m) ? 0 : 1;
  if (!write_png(view, shade(view, pixels))) return 1;
  std::printf("%s: %zu rays, %zu hits\n", view.out.c_str(), pixels.size(), hits);
  return hits > 0 ? 0 : 1;
}
