// Drawings in every style, and the lecture's ways to draw silhouettes beside each other, each with its defect measured.
//   drawing_gallery --out DIR --server PROGRAM [--commit TEXT] [--command TEXT]
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "client/draw/svg.hpp"
#include "tests/drawing/gallery/stage.hpp"
#include "tests/studies/report/page/page.hpp"
#include "tests/studies/report/page/provenance.hpp"

namespace collided::drawing_test {
namespace {

using report::Figure;
using report::Row;

constexpr double kWidth_px = 4;

struct Page {
  std::vector<Figure> figures;
  std::vector<Row> rows;

  void add(const std::string& title, const std::string& caption, const std::string& body, std::vector<Row> measured) {
    figures.push_back({fmt::format("f{}", figures.size() + 1), title, caption, body, report::rows_table(measured)});
    rows.insert(rows.end(), measured.begin(), measured.end());
  }
};

draw::DrawOptions general_view(double width_px) {
  draw::DrawOptions options;
  options.view = {.from = Vec3(3.1, -5.3, 4.2), .at = Vec3(0, 0, 0), .field_of_view_rad = 0.6, .width_px = width_px};
  options.crease_cosine = 0.5;
  return options;
}

/// Black pixels on paper.
std::string picture_of(const Mask& mask, const std::string& title) {
  draw::Pixels pixels{mask.width, mask.height, {}, {draw::kInk}};
  for (const std::uint8_t black : mask.black) pixels.numbers.push_back(black != 0 ? 0 : draw::Pixels::kPaperPixel);
  return draw::as_svg(
      {.width_px = double(mask.width), .height_px = double(mask.height), .title = title, .pixels = pixels});
}

Row row(const std::string& study, const std::string& scene, const std::string& series, const std::string& note) {
  Row one;
  one.study = study;
  one.scene = scene;
  one.series = series;
  one.note = note;
  return one;
}

std::string width_note(const Widths& widths) {
  return fmt::format("{:.1f} px wide on average, from {:.1f} to {:.1f}, standard deviation {:.0f} %", widths.mean_px(),
                     widths.least_px(), widths.most_px(), 100 * widths.spread());
}

struct NamedMesh {
  const char* name;
  MeshShape mesh;
};
std::vector<NamedMesh> three_meshes() {
  return {{"cube", cube(1)}, {"sphere", sphere(1.2, 48, 96)}, {"torus", torus(1, 0.4, 64, 32)}};
}

void add_styles(Stage& stage, Page& page) {
  static constexpr const char* kNames[] = {"wireframe", "hidden-line", "obscured-line", "haloed", "toon", "hatched"};
  struct Scene {
    const char* name;
    const char* path;
    double crease_cosine;
    Vec3 up;
  };
  for (const Scene& scene : {Scene{"house", "/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc", 0.866, Vec3::UnitZ()},
                             Scene{"bunny", "/usr/share/glmark2/models/bunny.obj", 0.34, Vec3::UnitY()}}) {
    std::string body;
    std::vector<Row> rows;
    if (!stage.load(scene.path)) {
      page.add(std::string("Styles: the ") + scene.name, fmt::format("{} is not installed.", scene.path), "", {});
      continue;
    }
    for (int style = 0; style < 6; ++style) {
      draw::DrawOptions options;
      options.view = {.up = scene.up, .width_px = 700};
      options.style = static_cast<draw::Style>(style);
      options.crease_cosine = scene.crease_cosine;
      // The lines of a whole house inside are a grey surface.
      if (style == 0 || style == 3) options.crease_cosine = 0;
      Stage::Shot shot = stage.shoot(options, false);
      shot.drawing.picture.title = fmt::format("{}, {}", scene.name, kNames[style]);
      body += draw::as_svg(shot.drawing.picture);
      rows.push_back(row(
          "styles", scene.name, kNames[style],
          fmt::format("{} segments, {} rays, {} undecided", shot.drawing.segments.size(), shot.rays, shot.undecided)));
    }
    page.add(std::string("Styles: the ") + scene.name, "Wireframe, hidden-line, obscured-line, haloed, toon, hatched.",
             body, rows);
  }
}

// A66
void add_biased(Stage& stage, Page& page) {
  std::string body;
  std::vector<Row> rows;
  for (const auto& [name, mesh] : three_meshes()) {
    stage.set({mesh});
    const Stage::Shot shot = stage.shoot(general_view(360), true);
    const double depth_m = shot.drawing.camera.project(Vec3::Zero()).depth_m;
    for (const auto& [bias, amount, word] : {std::tuple(Bias::fixed, 0.35, "fixed"),
                                             std::tuple(Bias::non_linear, 0.35 / (depth_m * depth_m), "non-linear"),
                                             std::tuple(Bias::by_angle, 6.0, "by angle")}) {
      const Mask mask = biased_back_faces(shot.polygons, shot.drawing.camera, shot.buffers, bias, amount);
      body += picture_of(mask, fmt::format("{}, bias {}", name, word));
      rows.push_back(
          row("biased back faces", name, word, width_note(widths_across_silhouette(mask, shot.drawing, 0, 15))));
    }
  }
  page.add("Back faces pulled to the eye",
           "Black back faces over the depth buffer of the front ones, pulled by the same depth, by the same step of 1 "
           "/ depth, or by their "
           "slope. The defect: lines are as wide as front and back are close, so not of one width, and a cube gets "
           "none or too much.",
           body, rows);
}

// A67
void add_fattened(Stage& stage, Page& page) {
  std::string body;
  std::vector<Row> rows;
  std::vector<NamedMesh> meshes = three_meshes();
  // Slices of a pole: triangles that are thin.
  meshes.push_back({"sphere of 4 slices and 200 rings", sphere(1.2, 200, 4)});
  for (const auto& [name, mesh] : meshes) {
    stage.set({mesh});
    const Stage::Shot shot = stage.shoot(general_view(360), true);
    const Mask mask = fattened_back_faces(shot.polygons, shot.drawing.camera, shot.buffers, kWidth_px);
    body += picture_of(mask, fmt::format("{}, fattened by {} px", name, kWidth_px));
    rows.push_back(row("fattened triangles", name, fmt::format("{} px asked", kWidth_px),
                       width_note(widths_across_silhouette(mask, shot.drawing, 2, 40))));
  }
  page.add("Triangles fattened",
           "Each back face grown by the same width in the picture. Right on fat triangles, as the cube's are; the "
           "defect: a sharp corner grows by the width over the sine of half "
           "its angle, so that triangles that are thin, or are seen edge-on as those of round things are at their "
           "silhouette, stick out as needles.",
           body, rows);
}

// A68
void add_shells(Stage& stage, Page& page) {
  std::string body;
  std::vector<Row> rows;
  for (const auto& [name, mesh] : three_meshes()) {
    stage.set({mesh});
    const Stage::Shot shot = stage.shoot(general_view(360), true);
    const double distance_m = kWidth_px * shot.drawing.camera.pixel_m(Vec3::Zero());
    for (const bool is_smooth : {true, false}) {
      const std::vector<Vec3> normals = is_smooth ? smooth_normals(shot.polygons) : flat_normals(shot.polygons);
      const Mask mask = expanded_shell(shot.polygons, normals, distance_m, shot.drawing.camera, shot.buffers);
      body += picture_of(mask, fmt::format("{}, {} normals", name, is_smooth ? "smooth" : "hard"));
      rows.push_back(
          row("expanded shell", name, is_smooth ? "normals of all at a corner" : "a normal a side",
              fmt::format("{}; widest gap {:.1f} px", width_note(widths_across_silhouette(mask, shot.drawing, 2, 15)),
                          widest_gap_px(mask, shot.buffers, shot.drawing, kWidth_px / 2))));
    }
  }
  page.add("The expanding shell",
           "Back faces of a copy whose vertices were moved along their normals. Right on what is round; the defect: "
           "where a corner has a normal a side, as a cube's "
           "has, the sides come apart and the outline has gaps.",
           body, rows);
}

// A69
void add_edge_images(Stage& stage, Page& page) {
  std::string body;
  std::vector<Row> rows;
  for (const auto& [name, mesh] : three_meshes()) {
    stage.set({mesh});
    const Stage::Shot shot = stage.shoot(general_view(360), true);
    const Mask mask = edge_image(shot.buffers, shot.drawing.camera, std::cos(0.6), 2);
    const Agreement found = agreement(mask, shot.drawing);
    body += picture_of(mask, fmt::format("{}, edges of its depth and normals", name));
    rows.push_back(row(
        "edges of the buffers", name, "depth and normals",
        fmt::format("recall {:.4f} of {} pixels of lines that are seen, precision {:.3f} of {} black pixels, {} rays",
                    found.recall(), found.line_pixels, found.precision(), found.black_pixels, shot.rays)));
  }
  page.add("Edges of depth and normals",
           "A ray a pixel; black where depths do not lie in one plane or normals differ. Finds the cube's corners, "
           "where the shell fails. The defect: lines are "
           "a pixel or two of the picture's own grid, and it takes a ray a pixel.",
           body, rows);
}

// A72
void add_biased_lines(Stage& stage, Page& page) {
  std::vector<Row> rows;
  std::string body;
  for (const auto& [name, mesh] : three_meshes()) {
    stage.set({mesh});
    for (const double width_px : {150.0, 400.0, 1000.0}) {
      const Stage::Shot shot = stage.shoot(general_view(width_px), true);
      const LinePixels without = biased_lines(shot.buffers, shot.drawing.camera, shot.drawing, 0);
      const LinePixels with = biased_lines(shot.buffers, shot.drawing.camera, shot.drawing, without.needed_m);
      rows.push_back(
          row("lines with bias", name, fmt::format("{} px", width_px),
              fmt::format("without bias {} pixels lost; bias {:.3g} m ({:.1f} pixels): {} lost, {} of hidden lines "
                          "drawn; by rays: bias {:.2g} m, none lost",
                          without.lost, without.needed_m, without.needed_m / shot.drawing.camera.pixel_m(Vec3::Zero()),
                          with.lost, with.leaked, shot.drawing.bias_m)));
      if (width_px == 400) body += draw::as_svg(shot.drawing.picture);
    }
  }
  page.add("Lines over polygons with a bias",
           "Lines drawn where they are not behind the depth buffer by more than a bias, at three zooms: the least that "
           "loses no pixel of a line. The defect: "
           "it takes pixels' worth of depth, and lets hidden lines through where surfaces are close. The drawings here "
           "decide by rays instead and need a hundredth of a pixel.",
           body, rows);
}

report::Heading heading() {
  return {"Collided: a gallery of drawings",
          "What <code>collide draw</code> draws by the service's own rays, and the older ways to draw silhouettes over "
          "depth buffers that the same rays have cast, each with its defect "
          "measured.",
          "gallery.csv"};
}

}  // namespace

int run(int argc, char** argv) {
  std::map<std::string, std::string> given{
      {"--out", ""}, {"--server", ""}, {"--commit", "not given"}, {"--command", "drawing_gallery"}};
  for (int i = 1; i + 1 < argc; i += 2) {
    if (!given.contains(argv[i])) throw std::invalid_argument(fmt::format("unknown argument '{}'", argv[i]));
    given[argv[i]] = argv[i + 1];
  }
  if (given["--out"].empty() || given["--server"].empty())
    throw std::invalid_argument("--out DIR --server PROGRAM are missing");
  std::filesystem::create_directories(given["--out"]);
  Stage stage(given["--server"]);
  Page page;
  for (const auto add : {add_styles, add_edge_images, add_shells, add_fattened, add_biased, add_biased_lines})
    add(stage, page);
  report::Provenance from;
  from.machine = report::machine();
  from.commit = given["--commit"];
  from.command = given["--command"];
  report::write_rows(given["--out"] + "/gallery.csv", page.rows, from);
  std::ofstream(given["--out"] + "/gallery.html") << report::page(page.figures, from, report::today(), heading());
  for (const Row& measured : page.rows)
    fmt::print("{}: {}, {}: {}\n", measured.study, measured.scene, measured.series, measured.note);
  fmt::print("{}/gallery.html\n", given["--out"]);
  return page.rows.empty() ? 1 : 0;
}

}  // namespace collided::drawing_test

int main(int argc, char** argv) try {
  return collided::drawing_test::run(argc, argv);
} catch (const std::exception& error) {
  fmt::print(stderr, "error: {}\n", error.what());
  return 2;
}
