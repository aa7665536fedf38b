#include "studio/base/token_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/core/file_handle.hpp"
#include "base/core/files.hpp"
#include "studio/base/access.hpp"

namespace pliant::studio {
namespace {

bool is_letter_or_digit(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

Result<std::string> make_token(const std::filesystem::path& file) {
    const FileHandle made(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (!made.is_open()) return input_error("{}: cannot be made: {}", file.string(), std::strerror(errno));
    std::string token = random_key();
    const std::string line = token + "\n";
    if (::write(made.number(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
        return input_error("{}: cannot be written: {}", file.string(), std::strerror(errno));
    return token;
}

}  // namespace

Result<std::string> read_or_make_token(const std::filesystem::path& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0 && errno == ENOENT) return make_token(file);
    Result<std::string> text = read_file(file, 4096);
    if (!text) return text;
    if ((status.st_mode & S_IRWXO) != 0)
        return input_error("{}: everybody on this computer can use it; \"chmod o= {}\" changes that", file.string(),
                           file.string());
    while (!text->empty() && (text->back() == '\n' || text->back() == '\r')) text->pop_back();
    if (text->size() < 16 || text->size() > 256 || !std::all_of(text->begin(), text->end(), is_letter_or_digit))
        return input_error("{}: a token is 16 to 256 letters and digits on one line; without the file one is made",
                           file.string());
    return text;
}

}  // namespace pliant::studio
