#pragma once

#include <array>
#include <cstdint>
#include <future>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <collided/client.hpp>

namespace collided::cli {

/// The kinds of questions that can be typed or read from files.
enum class QuestionKind { ray, sphere, box, near, inside };
inline constexpr std::size_t kQuestionKinds = 5;
std::string_view name_of(QuestionKind kind);

/// Questions of one kind. The alternatives are in the order of QuestionKind.
using Questions = std::variant<std::vector<RayQuestion>, std::vector<SphereQuestion>, std::vector<BoxQuestion>,
                               std::vector<NearQuestion>, std::vector<InsideQuestion>>;

/// An empty list of that kind.
Questions no_questions(QuestionKind kind);
std::size_t question_count(const Questions& questions);
/// Client::ask_async and Client::ask, for any kind.
std::future<Result<Answers>> ask_async(Client& client, Questions questions, const AskOptions& options);
Result<Answers> ask(Client& client, const Questions& questions, const AskOptions& options);

/// One number of a question in a file: a CSV column.
struct QuestionColumn {
  std::string_view name;
  std::string_view other_name;  // accepted too; may be empty
};

/// A key of a question in JSON. Its value has `count` numbers, for the columns from `first` on.
struct JsonKey {
  std::string_view name;
  std::size_t first;
  std::size_t count;
};

inline constexpr std::size_t kMostColumns = 16;

/// The form of a kind of question in files.
struct QuestionForm {
  std::string_view plural;
  std::span<const QuestionColumn> columns;
  std::span<const JsonKey> keys;
  std::size_t fewest_bare;  // a line without a header has at least this many numbers, for the first columns,
  std::size_t most_bare;    // and at most this many
};
const QuestionForm& form_of(QuestionKind kind);

/// The numbers of one question by column, and a bit for each that was given.
struct Numbers {
  std::array<double, kMostColumns> value{};
  std::uint32_t given = 0;

  void set(std::size_t column, double number) {
    value[column] = number;
    given |= std::uint32_t{1} << column;
  }
  bool has(std::size_t first, std::size_t count) const {
    const std::uint32_t bits = ((std::uint32_t{1} << count) - 1) << first;
    return (given & bits) == bits;
  }
  Vec3 vector(std::size_t first) const { return {value[first], value[first + 1], value[first + 2]}; }
};

/// Adds the question with these numbers. Throws Failure if numbers are missing or are not a valid question.
void add_question(Questions& questions, const Numbers& numbers);

/// The columns of each kind by name, for files and the command line.
namespace column {
enum RayColumn : std::size_t { kFrom = 0, kDirection = 3, kLength = 6, kTo = 7 };
enum SphereColumn : std::size_t { kSphereCenter = 0, kRadius = 3 };
enum BoxColumn : std::size_t { kLow = 0, kHigh = 3, kBoxCenter = 6, kSize = 9, kQuaternion = 12 };
enum NearColumn : std::size_t { kPoint = 0, kReach = 3 };
}  // namespace column

/// The rotation by roll, pitch and yaw, about the fixed x, y and z axes in this order.
Quat from_roll_pitch_yaw(const Vec3& angles_rad);

/// A rotation of four numbers w x y z; throws Failure unless the norm is 1 within 1e-6, then normalises.
Quat unit_quaternion(double w, double x, double y, double z);

}  // namespace collided::cli
