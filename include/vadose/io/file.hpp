// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Output files whose every failure is told with path and reason.

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace vadose::io {

/// Thrown when something cannot be written; the message has the path and the system's reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Thrown when something cannot be read; the message has the path and what is wrong.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Creates the directory and those above it; nothing happens where it exists already.
inline void create_directories(const std::string& directory) {
  if (directory.empty()) return;
  std::error_code code;
  std::filesystem::create_directories(directory, code);
  if (code || !std::filesystem::is_directory(directory, code))
    throw OutputError("cannot create directory '" + directory +
                      "': " + (code ? code.message() : "a file of this name exists"));
}

/// A file open for writing. Closes itself; call close() to learn whether all of it was written.
class File {
 public:
  /// Opens `path` for binary writing (replacing what is there) or appending; creates the directory.
  explicit File(std::string path, bool append = false) : path_(std::move(path)) {
    create_directories(std::filesystem::path(path_).parent_path().string());
    errno = 0;
    file_ = std::fopen(path_.c_str(), append ? "ab" : "wb");
    if (!file_) fail("open");
  }
  /// Takes the open file of another.
  File(File&& other) noexcept
      : path_(std::move(other.path_)), file_(std::exchange(other.file_, nullptr)) {}
  /// Exchanges the open files.
  File& operator=(File&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(file_, other.file_);
    return *this;
  }
  ~File() {
    if (file_) std::fclose(file_);
  }

  const std::string& path() const noexcept { return path_; }
  bool is_open() const noexcept { return file_ != nullptr; }  ///< until close()

  /// Writes `bytes` bytes.
  void write(const void* data, std::size_t bytes) {
    require_open();
    if (bytes == 0) return;
    errno = 0;
    if (std::fwrite(data, 1, bytes, file_) != bytes) fail("write");
  }
  /// Writes text.
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// Writes formatted text, as printf does.
  __attribute__((format(printf, 2, 3))) void print(const char* format, ...) {
    require_open();
    errno = 0;
    std::va_list arguments;
    va_start(arguments, format);
    const int written = std::vfprintf(file_, format, arguments);
    va_end(arguments);
    if (written < 0) fail("write");
  }

  /// Hands everything written so far to the system.
  void flush() {
    require_open();
    errno = 0;
    if (std::fflush(file_) != 0) fail("write");
  }

  /// Writes text and hands it to the system, all of it or nothing: where that fails (a full disk), the
  /// file ends as before and can go on.
  void append_whole(std::string_view text) {
    flush();
    const off_t end = ::ftello(file_);
    try {
      write(text);
      flush();
    } catch (const OutputError&) {
      std::clearerr(file_);
      if (end >= 0 && ::ftruncate(::fileno(file_), end) == 0) ::fseeko(file_, end, SEEK_SET);
      throw;
    }
  }

  /// Hands everything written so far to the disk: it outlives a power failure.
  void sync() {
    flush();
    errno = 0;
    if (::fsync(::fileno(file_)) != 0) fail("write");
  }

  /// Writes what is buffered and closes; a second call does nothing.
  void close() {
    if (!file_) return;
    errno = 0;
    std::FILE* file = std::exchange(file_, nullptr);
    const bool sound = std::ferror(file) == 0;
    if (std::fclose(file) != 0 || !sound) fail("write");
  }

 private:
  void require_open() const {
    if (!file_) throw OutputError("cannot write file '" + path_ + "': it is closed");
  }
  [[noreturn]] void fail(const char* action) const {
    const int reason = errno;
    throw OutputError("cannot " + std::string(action) + " file '" + path_ +
                      "': " + (reason ? std::strerror(reason) : "unknown reason"));
  }

  std::string path_;
  std::FILE* file_ = nullptr;
};

/// Writes beside `path` and takes its place only when complete: whoever reads `path` finds the old
/// or the new content, never a part of it.
class ReplacingFile {
 public:
  /// Opens the file beside `path`.
  explicit ReplacingFile(std::string path) : path_(std::move(path)), file_(path_ + ".part") {}
  ReplacingFile(const ReplacingFile&) = delete;
  ReplacingFile& operator=(const ReplacingFile&) = delete;
  ~ReplacingFile() {
    if (done_) return;
    std::error_code ignored;
    std::filesystem::remove(file_.path(), ignored);
  }

  /// The new content.
  File& file() noexcept { return file_; }

  /// Closes the new content and puts it at `path`. Durable: on the disk before it takes its place.
  void commit(bool durable = false) {
    if (durable) file_.sync();
    file_.close();
    std::error_code code;
    std::filesystem::rename(file_.path(), path_, code);
    if (code) throw OutputError("cannot write file '" + path_ + "': " + code.message());
    done_ = true;
    if (durable) sync_directory();
  }

 private:
  /// The new name outlives a power failure too, where directories can be synchronised.
  void sync_directory() const noexcept {
    const std::string parent = std::filesystem::path(path_).parent_path().string();
    const int directory = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY);
    if (directory < 0) return;
    ::fsync(directory);
    ::close(directory);
  }

  std::string path_;
  File file_;
  bool done_ = false;
};

}  // namespace vadose::io
