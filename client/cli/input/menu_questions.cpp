#include "client/cli/input/menu_questions.hpp"

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/question_reader.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

void append(const Vec3& v, std::vector<double>& numbers) { numbers.insert(numbers.end(), {v.x(), v.y(), v.z()}); }

void append(const RayQuestion& ray, std::vector<double>& numbers) {
  append(ray.origin, numbers);
  append(ray.direction, numbers);
  numbers.push_back(ray.length_m);
}
void append(const SphereQuestion& sphere, std::vector<double>& numbers) {
  append(sphere.center, numbers);
  numbers.push_back(sphere.radius_m);
}
void append(const BoxQuestion& box, std::vector<double>& numbers) {
  append(box.center, numbers);
  append(box.half_m, numbers);
  numbers.insert(numbers.end(), {box.rotation.w(), box.rotation.x(), box.rotation.y(), box.rotation.z()});
}
void append(const NearQuestion& near, std::vector<double>& numbers) {
  append(near.point, numbers);
  numbers.push_back(near.within_m);
}
void append(const InsideQuestion& inside, std::vector<double>& numbers) { append(inside.point, numbers); }

}  // namespace

std::vector<double> read_menu_questions(const std::string& path, QuestionKind kind, int in) {
  const InputFile file(path, in);
  QuestionReader reader(file, kind);
  Questions questions = no_questions(kind);
  QuestionReader::Line line;
  for (;;) {
    const QuestionReader::Found found = reader.next(questions, line);
    if (found == QuestionReader::Found::refused)
      throw bad_use(fmt::format("{} {}; nothing was asked", file.name(), line.refusal));
    if (found == QuestionReader::Found::end) break;
    if (question_count(questions) > wire_contract::command::kMostMenuQuestions) {
      throw bad_use(fmt::format("{} holds more than {} questions, the most that menu takes; nothing was asked",
                                file.name(), format_count(wire_contract::command::kMostMenuQuestions)));
    }
  }
  if (question_count(questions) == 0) throw bad_use(fmt::format("{} holds no question", file.name()));
  std::vector<double> numbers;
  std::visit(
      [&](const auto& all) {
        for (const auto& question : all) append(question, numbers);
      },
      questions);
  return numbers;
}

}  // namespace collided::cli
