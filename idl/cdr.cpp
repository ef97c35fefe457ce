#include "idl/cdr.hpp"

#include <bit>
#include <cstring>

#include "idl/messages.hpp"

namespace collided::wire {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

constexpr std::size_t kHeaderBytes = 4;
constexpr std::byte kPlainLittleEndian{1};

template <class Field>
concept Sequence = requires(Field& field) {
  field._buffer;
};
template <class Field>
concept Number = std::is_arithmetic_v<Field>;

/// A position in the bytes. Numbers are aligned to multiples of their size, counted from the end of the header.
class Position {
 public:
  std::size_t at() const { return at_; }

 protected:
  std::size_t padding(std::size_t alignment) const { return (alignment - at_ % alignment) % alignment; }
  std::size_t at_ = 0;
};

/// Counts the bytes that Write would fill.
class Measure : public Position {
 public:
  template <Number N>
  void operator()(const N&) {
    add(sizeof(N), 1);
  }
  template <std::size_t kRoom>
  void operator()(const char (&text)[kRoom]) {
    add(4, 1);
    at_ += std::strlen(text) + 1;
  }
  template <std::size_t kCount>
  void operator()(const double (&)[kCount]) {
    add(sizeof(double), kCount);
  }
  template <Sequence S>
  void operator()(const S& sequence) {
    add(4, 1);
    if (sequence._length > 0) add(sizeof(*sequence._buffer), sequence._length);
  }

 private:
  void add(std::size_t size, std::size_t count) { at_ += padding(size) + size * count; }
};

/// Writes fields; gaps before aligned numbers become zeros.
class Write : public Position {
 public:
  explicit Write(std::byte* out) : out_(out) {}

  template <Number N>
  void operator()(const N& number) {
    put(std::span(&number, 1));
  }
  template <std::size_t kRoom>
  void operator()(const char (&text)[kRoom]) {
    const auto length = static_cast<std::uint32_t>(std::strlen(text) + 1);
    (*this)(length);
    put(std::span<const char>(text, length));
  }
  template <std::size_t kCount>
  void operator()(const double (&numbers)[kCount]) {
    put(std::span<const double>(numbers));
  }
  template <Sequence S>
  void operator()(const S& sequence) {
    (*this)(sequence._length);
    if (sequence._length > 0) put(std::span(sequence._buffer, sequence._length));
  }

 private:
  template <class Element>
  void put(std::span<Element> elements) {
    const std::size_t gap = padding(sizeof(Element));
    std::memset(out_ + at_, 0, gap);
    std::memcpy(out_ + at_ + gap, elements.data(), elements.size_bytes());
    at_ += gap + elements.size_bytes();
  }
  std::byte* out_;
};

/// Reads fields and checks every length against the remaining bytes.
class Read : public Position {
 public:
  explicit Read(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool good() const { return good_; }

  template <Number N>
  void operator()(N& number) {
    const std::byte* from = take(sizeof(N), 1);
    if (from == nullptr) return;
    if constexpr (std::is_same_v<N, bool>) {
      good_ = *from <= std::byte{1};
      number = *from == std::byte{1};
    } else {
      std::memcpy(&number, from, sizeof(N));
    }
  }
  template <std::size_t kRoom>
  void operator()(char (&text)[kRoom]) {
    std::uint32_t length = 0;
    (*this)(length);
    const std::byte* from = take(1, length);
    if (from == nullptr) return;
    const bool fits = length >= 1 && length <= kRoom && std::memchr(from, 0, length) == from + length - 1;
    if (fits) std::memcpy(text, from, length);
    good_ = fits;
  }
  template <std::size_t kCount>
  void operator()(double (&numbers)[kCount]) {
    if (const std::byte* from = take(sizeof(double), kCount)) std::memcpy(numbers, from, sizeof(numbers));
  }
  template <Sequence S>
  void operator()(S& sequence) {
    using Element = std::remove_pointer_t<decltype(sequence._buffer)>;
    std::uint32_t length = 0;
    (*this)(length);
    if (sequence._release) dds_free(sequence._buffer);
    sequence = {};
    if (!good_ || length == 0) return;
    const std::byte* from = take(sizeof(Element), length);
    if (from == nullptr) return;
    sequence._buffer = static_cast<Element*>(dds_alloc(sizeof(Element) * length));
    sequence._release = true;
    std::memcpy(sequence._buffer, from, sizeof(Element) * length);
    sequence._length = sequence._maximum = length;
  }

 private:
  /// The next `count` elements. If the bytes end before them: null, and good() is false from then on.
  const std::byte* take(std::size_t size, std::size_t count) {
    const std::size_t gap = padding(size);
    if (!good_ || gap > bytes_.size() - at_ || count > (bytes_.size() - at_ - gap) / size) {
      good_ = false;
      return nullptr;
    }
    const std::byte* from = bytes_.data() + at_ + gap;
    at_ += gap + size * count;
    return from;
  }
  std::span<const std::byte> bytes_;
  bool good_ = true;
};

std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

}  // namespace

template <class T>
std::size_t cdr_size(const T& sample) {
  Measure measure;
  for_each_field(sample, measure);
  return kHeaderBytes + padded(measure.at());
}

template <class T>
void write_cdr(const T& sample, std::span<std::byte> out) {
  Write write(out.data() + kHeaderBytes);
  for_each_field(sample, write);
  const std::size_t tail = padded(write.at()) - write.at();
  std::memset(out.data() + kHeaderBytes + write.at(), 0, tail);
  // The last byte of the header is the number of padding bytes at the end.
  const std::byte header[kHeaderBytes] = {std::byte{0}, kPlainLittleEndian, std::byte{0}, static_cast<std::byte>(tail)};
  std::memcpy(out.data(), header, kHeaderBytes);
}

template <class T>
bool read_cdr(std::span<const std::byte> bytes, dds::Sample<T>& sample) {
  if (bytes.size() < kHeaderBytes || bytes[0] != std::byte{0} || bytes[1] != kPlainLittleEndian) return false;
  Read read(bytes.subspan(kHeaderBytes));
  for_each_field(*sample, read);
  return read.good() && bytes.size() - kHeaderBytes - read.at() < 4;
}

#define COLLIDED_CDR_OF(T)                                 \
  template std::size_t cdr_size(const T&);                 \
  template void write_cdr(const T&, std::span<std::byte>); \
  template bool read_cdr(std::span<const std::byte>, dds::Sample<T>&)
COLLIDED_CDR_OF(Definition);
COLLIDED_CDR_OF(PoseBatch);
COLLIDED_CDR_OF(Query);
COLLIDED_CDR_OF(Reply);
COLLIDED_CDR_OF(EventFrame);
COLLIDED_CDR_OF(ContactShard);
COLLIDED_CDR_OF(StandingFrame);
COLLIDED_CDR_OF(StandingShard);
COLLIDED_CDR_OF(ProbeFrame);
COLLIDED_CDR_OF(Status);
#undef COLLIDED_CDR_OF

}  // namespace collided::wire
