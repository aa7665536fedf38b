#include "base/core/file_handle.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

using namespace pliant;

namespace {

int opened() {
    const int number = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    REQUIRE(number >= 0);
    return number;
}

bool is_open(int number) {
    return ::fcntl(number, F_GETFD) >= 0;
}

}  // namespace

TEST_CASE("a file is closed once, with its owner") {
    const int number = opened();
    {
        FileHandle file(number);
        CHECK(file.is_open());
        CHECK(file.number() == number);
        CHECK(is_open(number));
    }
    CHECK_FALSE(is_open(number));

    FileHandle file(opened());
    const int first = file.number();
    file.close();
    CHECK_FALSE(file.is_open());
    CHECK_FALSE(is_open(first));
    const FileHandle other(opened());  // the system gives the lowest free number, so the same again
    REQUIRE(other.number() == first);
    file.close();
    CHECK(is_open(first));
}

TEST_CASE("a moved file stays open, and one replaced by assignment is closed") {
    const int number = opened();
    FileHandle file(number);
    FileHandle moved(std::move(file));
    CHECK(is_open(number));
    CHECK(moved.number() == number);
    CHECK_FALSE(file.is_open());

    const int replaced = opened();
    {
        FileHandle target(replaced);
        target = std::move(moved);
        CHECK(target.number() == number);
        FileHandle last(std::move(moved));
        CHECK(is_open(number));
    }
    CHECK_FALSE(is_open(number));
    CHECK_FALSE(is_open(replaced));
}

TEST_CASE("closing preserves errno") {
    errno = ENOENT;
    { const FileHandle none(-1); }
    { const FileHandle wrong(1 << 20); }  // no such descriptor: close() fails with EBADF
    CHECK(errno == ENOENT);
}
