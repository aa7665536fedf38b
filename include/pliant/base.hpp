/// @file
/// Common to the whole interface: points, errors, progress.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

/// Marks the symbols that the shared library exports.
#define PLIANT_API __attribute__((visibility("default")))

/// Simulates multi-material soft robots, and slices, plans and prints them.
///
/// Robot, Model, State and results keep their value when they are moved from; what holds a solver or a view may then
/// only be assigned to or destroyed.
namespace pliant {

/// x, y and z.
using Point = std::array<double, 3>;

/// An error. Its message is one line: where it occurred, what is wrong, and what would be right. Functions that read a
/// robot or a printer file, such as Robot::load(), Robot::parse() and slice_job(), and the constructors of Model give a
/// line for each mistake that they find. Thrown by every function that can fail.
///
/// file(), line() and key() are known for most mistakes in text files: robot and printer files, tables of measurements,
/// meshes and surfaces. If the message has several lines, they locate the mistake of the first. For the binary files
/// that Pliant writes (states, checkpoints, jobs) line and key are unknown, and mostly the file too, even if the
/// message names it. For arguments all three are unknown.
class PLIANT_API Failure : public std::runtime_error {
public:
    /// Who can fix it.
    enum class Kind {
        input,      ///< the caller: a file, a key or an argument is wrong
        failed,     ///< the operation failed, for example a disk or a solver
        cancelled,  ///< the caller cancelled
    };
    /// `line` (from 1) and `key` locate the error in `file`; 0 and "" if unknown.
    Failure(Kind kind, const std::string& message, std::string file = {}, int line = 0, std::string key = {});
    ~Failure() override;
    /// Copies, as exceptions must.
    Failure(const Failure&);
    /// Copies, as exceptions must.
    Failure& operator=(const Failure&);

    /// Kind of the error.
    [[nodiscard]] Kind kind() const noexcept { return kind_; }
    /// The file that the error is in; "" if unknown or none.
    [[nodiscard]] const std::string& file() const noexcept { return file_; }
    /// The line in the file, from 1; 0 if unknown.
    [[nodiscard]] int line() const noexcept { return line_; }
    /// The key in the file, or kind and name of the thing concerned, such as: body "tip"; "" if unknown.
    [[nodiscard]] const std::string& key() const noexcept { return key_; }

private:
    Kind kind_;
    std::string file_;
    int line_;
    std::string key_;
};

/// Progress callback: called many times a second with the current stage and the completed share, 0 to 1. Returning
/// false cancels, which ends in a Failure of kind `cancelled`, unless the function says otherwise. May be empty.
///
/// It is called on the thread that called the function. If it throws, the work ends as if cancelled, and the caller
/// gets the exception unchanged. Exceptions of other callbacks also reach the caller unchanged, unless a callback must
/// not throw.
using Watch = std::function<bool(std::string_view stage, double share)>;

/// @cond
/// A pointer to shared, immutable data. Moving copies it: what was moved from keeps its value, and can still be used.
template <class T>
class SharedData : public std::shared_ptr<T> {
public:
    SharedData() = default;
    SharedData(std::shared_ptr<T> data) noexcept : std::shared_ptr<T>(std::move(data)) {}
    SharedData(const SharedData&) noexcept = default;
    SharedData& operator=(const SharedData&) noexcept = default;
    ~SharedData() = default;
};
/// @endcond

/// Converts a text with a unit, as in robot files, to SI: quantity("4 mm", "m") is 0.004. `unit` is the required unit:
/// m, s, N, Pa, m^3, kg/m^3 or N/m.
/// @throws Failure if `unit` is none of these, or the text is not a number with a suitable unit; the message names the
/// suitable units.
[[nodiscard]] PLIANT_API double quantity(std::string_view text, std::string_view unit);

/// Version of the library, such as "1.0.0".
[[nodiscard]] PLIANT_API std::string_view version() noexcept;

}  // namespace pliant
