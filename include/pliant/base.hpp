/// @file
/// What all of Pliant's library shares: points, errors, progress.
#pragma once

#include <array>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

/// Marks what the shared library shows.
#define PLIANT_API __attribute__((visibility("default")))

/// Simulates multi-material soft robots, and slices, plans and prints them.
namespace pliant {

/// x, y and z.
using Point = std::array<double, 3>;

/// What went wrong, in one line for people: where, what, and what would be right. Thrown by everything that can fail.
class PLIANT_API Failure : public std::runtime_error {
public:
    /// Who is to look at it.
    enum class Kind {
        input,      ///< a file, a key or an argument is wrong
        failed,     ///< the work itself did not succeed: a disk, a solver
        cancelled,  ///< the caller asked for an end
    };
    /// `line` of `file`, from 1, and `key` in it; 0 and "" where they are not known.
    Failure(Kind kind, const std::string& message, std::string file = {}, int line = 0, std::string key = {});
    ~Failure() override;
    /// A copy, as exceptions must be.
    Failure(const Failure&);
    /// A copy, as exceptions must be.
    Failure& operator=(const Failure&);

    /// Who is to look at it.
    [[nodiscard]] Kind kind() const noexcept { return kind_; }
    /// The file that the error is in; "" if it is in none.
    [[nodiscard]] const std::string& file() const noexcept { return file_; }
    /// Its line, from 1; 0 where that is not known.
    [[nodiscard]] int line() const noexcept { return line_; }
    /// The key there; "" where that is not known.
    [[nodiscard]] const std::string& key() const noexcept { return key_; }

private:
    Kind kind_;
    std::string file_;
    int line_;
    std::string key_;
};

/// Told what is being done and which share of it is done, many times a second; false asks for an end, which comes as a
/// Failure of kind `cancelled`. May be empty.
using Watch = std::function<bool(std::string_view stage, double share)>;

/// Value in SI units of a text as robot files have it: quantity("4 mm", "m") is 0.004. `unit` says what it must be: m,
/// s, N, Pa, m^3, kg/m^3 or N/m.
/// @throws Failure where the text is no number with such a unit; it names the units that would be right.
[[nodiscard]] PLIANT_API double quantity(std::string_view text, std::string_view unit);

/// Version of the library, as "1.0.0".
[[nodiscard]] PLIANT_API std::string_view version() noexcept;

}  // namespace pliant
