// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Sections of numbers in a binary file, each with its length and checksum: what a checkpoint is
/// made of. A reader trusts nothing: lengths are compared with the file before memory is taken.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <vadose/core/compensated_sum.hpp>
#include <vadose/io/file.hpp>

namespace vadose::io::detail {

/// Checksum of bytes. Each step is one-to-one in the eight bytes it takes: damage within eight bytes
/// is found for certain, other damage but for one case in 2^64.
inline std::uint64_t checksum(const void* data, std::size_t bytes) noexcept {
  const auto* p = static_cast<const unsigned char*>(data);
  std::uint64_t sum = 0x9e3779b97f4a7c15ull ^ bytes;
  const auto mix = [&sum](std::uint64_t word) {
    sum = (sum ^ word) * 0xff51afd7ed558ccdull;
    sum ^= sum >> 29;
  };
  for (; bytes >= 8; bytes -= 8, p += 8) {
    std::uint64_t word;
    std::memcpy(&word, p, 8);
    mix(word);
  }
  std::uint64_t rest = 0;
  if (bytes > 0) std::memcpy(&rest, p, bytes);
  mix(rest);
  return sum;
}

inline constexpr std::array<char, 8> checkpoint_magic = {'v', 'a', 'd', 'o', 's', 'e', '\r', '\n'};
inline constexpr std::uint32_t checkpoint_endian = 0x01020304;
/// Grows with every change of what is in the sections.
inline constexpr std::uint32_t checkpoint_version = 5;

/// Beginning of the file.
struct CheckpointHead {
  std::array<char, 8> magic = checkpoint_magic;
  std::uint32_t endian = checkpoint_endian;
  std::uint32_t version = checkpoint_version;
  std::uint64_t bytes = 0;     ///< of the whole file
  std::uint64_t sections = 0;  ///< number
  std::uint64_t check = 0;     ///< of what is above
};
/// Beginning of a section.
struct SectionHead {
  std::array<char, 16> name{};
  std::uint64_t bytes = 0;       ///< that follow
  std::uint64_t check = 0;       ///< of these
  std::uint64_t head_check = 0;  ///< of what is above
};

/// Takes values and keeps their bytes.
class SectionWriter {
 public:
  static constexpr bool reading = false;

  /// One number, enum or sum.
  template <class T>
  void value(std::string_view, const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(&v, sizeof v);
  }
  /// A list of numbers with its length.
  template <class T, class A>
  void list(std::string_view name, const std::vector<T, A>& values) {
    value(name, static_cast<std::uint64_t>(values.size()));
    bytes(values.data(), values.size() * sizeof(T));
  }
  /// A text with its length.
  void text(std::string_view name, const std::string& text) {
    value(name, static_cast<std::uint64_t>(text.size()));
    bytes(text.data(), text.size());
  }

  const std::vector<char>& data() const noexcept { return data_; }
  std::vector<char> take() && noexcept { return std::move(data_); }

 private:
  void bytes(const void* from, std::size_t count) {
    const char* p = static_cast<const char*>(from);
    data_.insert(data_.end(), p, p + count);
  }
  std::vector<char> data_;
};

/// Gives the values back in the same order; raises InputError that names the one that is wrong.
class SectionReader {
 public:
  static constexpr bool reading = true;

  SectionReader(std::string place, std::vector<char> data)
      : place_(std::move(place)), data_(std::move(data)) {}

  template <class T>
  void value(std::string_view name, T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    need(name, sizeof v);
    take(&v, sizeof v);
  }
  template <class T, class A>
  void list(std::string_view name, std::vector<T, A>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    values.resize(length(name, sizeof(T)));
    take(values.data(), values.size() * sizeof(T));
  }
  void text(std::string_view name, std::string& text) {
    text.resize(length(name, 1));
    take(text.data(), text.size());
  }

  /// Raises InputError about a value.
  [[noreturn]] void refuse(std::string_view name, const std::string& what) const {
    throw InputError(place_ + ": " + std::string(name) + " " + what);
  }
  /// Raises InputError unless what is left can hold `count` things of `size` bytes.
  void expect(std::string_view name, std::uint64_t count, std::size_t size) const {
    if (count > (data_.size() - at_) / size) refuse(name, "is larger than its section");
  }
  /// Everything has been read.
  void finish() const {
    if (at_ != data_.size()) throw InputError(place_ + " is longer than its values");
  }

 private:
  void need(std::string_view name, std::size_t bytes) const {
    if (bytes > data_.size() - at_) refuse(name, "is missing");
  }
  /// Length of a list; what is left must hold it.
  std::size_t length(std::string_view name, std::size_t size) {
    std::uint64_t count = 0;
    value(name, count);
    expect(name, count, size);
    return static_cast<std::size_t>(count);
  }
  void take(void* to, std::size_t bytes) noexcept {
    if (bytes > 0) std::memcpy(to, data_.data() + at_, bytes);
    at_ += bytes;
  }

  std::string place_;
  std::vector<char> data_;
  std::size_t at_ = 0;
};

/// Named sections on their way to a file.
class CheckpointWriter {
 public:
  void add(std::string_view name, SectionWriter section) {
    SectionHead head;
    std::memcpy(head.name.data(), name.data(), std::min(name.size(), head.name.size() - 1));
    head.bytes = section.data().size();
    head.check = checksum(section.data().data(), section.data().size());
    head.head_check = checksum(&head, offsetof(SectionHead, head_check));
    sections_.emplace_back(head, std::move(section).take());
  }

  /// The file appears complete, and on the disk, or not at all. Raises OutputError.
  void write(const std::string& path) const {
    CheckpointHead head;
    head.sections = sections_.size();
    head.bytes = sizeof head;
    for (const auto& [section, data] : sections_) head.bytes += sizeof section + data.size();
    head.check = checksum(&head, offsetof(CheckpointHead, check));
    ReplacingFile replacing(path);
    replacing.file().write(&head, sizeof head);
    for (const auto& [section, data] : sections_) {
      replacing.file().write(&section, sizeof section);
      replacing.file().write(data.data(), data.size());
    }
    replacing.commit(true);
  }

 private:
  std::vector<std::pair<SectionHead, std::vector<char>>> sections_;
};

/// Sections of a file one after the other. Raises InputError.
class CheckpointReader {
 public:
  explicit CheckpointReader(const std::string& path)
      : what_("cannot read checkpoint '" + path + "'"), file_(std::fopen(path.c_str(), "rb")) {
    if (!file_) fail(std::strerror(errno));
    try {
      open();
    } catch (...) {
      std::fclose(file_);
      throw;
    }
  }
  CheckpointReader(const CheckpointReader&) = delete;
  CheckpointReader& operator=(const CheckpointReader&) = delete;
  ~CheckpointReader() { std::fclose(file_); }

  /// The next section, which must have this name.
  SectionReader next(std::string_view name) {
    const std::string label = "section '" + std::string(name) + "'";
    SectionHead head;
    if (left_ < sizeof head || sections_ == 0) fail(label + " is missing");
    read(&head, sizeof head);
    if (head.head_check != checksum(&head, offsetof(SectionHead, head_check)))
      fail("the head of " + label + " is damaged");
    if (head.name.back() != 0 || std::string_view(head.name.data()) != name)
      fail(label + " is missing");
    if (head.bytes > left_) fail(label + " is cut off");
    std::vector<char> data(static_cast<std::size_t>(head.bytes));
    read(data.data(), data.size());
    if (head.check != checksum(data.data(), data.size())) fail(label + " is damaged");
    --sections_;
    return {what_ + ", " + label, std::move(data)};
  }
  /// No section is left.
  void finish() const {
    if (left_ != 0 || sections_ != 0) fail("more sections than expected");
  }

 private:
  void open() {
    if (std::fseek(file_, 0, SEEK_END) != 0) fail("not a file that can be read twice");
    const long size = std::ftell(file_);
    std::rewind(file_);
    CheckpointHead head;
    if (size < static_cast<long>(sizeof head)) fail("the file is too short");
    left_ = static_cast<std::uint64_t>(size);
    read(&head, sizeof head);
    if (head.magic != checkpoint_magic) fail("it is no checkpoint of this library");
    if (head.endian != checkpoint_endian) fail("it was written with another order of bytes");
    if (head.version != checkpoint_version)
      fail("its version is " + std::to_string(head.version) + ", this library reads version " +
           std::to_string(checkpoint_version));
    if (head.check != checksum(&head, offsetof(CheckpointHead, check)))
      fail("the head of the file is damaged");
    if (head.bytes != static_cast<std::uint64_t>(size))
      fail("the file has " + std::to_string(size) + " bytes, " + std::to_string(head.bytes) +
           " were written");
    sections_ = head.sections;
  }
  void read(void* to, std::size_t bytes) {
    errno = 0;
    if (bytes > 0 && std::fread(to, 1, bytes, file_) != bytes)
      fail(errno ? std::strerror(errno) : "the file ends early");
    left_ -= bytes;
  }
  [[noreturn]] void fail(const std::string& why) const { throw InputError(what_ + ": " + why); }

  std::string what_;
  std::FILE* file_;
  std::uint64_t left_ = 0, sections_ = 0;
};

}  // namespace vadose::io::detail
