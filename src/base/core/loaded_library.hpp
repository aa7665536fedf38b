// A shared library that is loaded while the program runs, by its file name: for libraries that most runs do not need,
// and whose loading would take longer than everything else before main.
#pragma once

#include <memory>

namespace pliant {

/// For a class that has the functions of one library in use. Either all that were looked up are present, or the library
/// counts as missing. Once loaded the library stays in the process, so that further objects cost nothing.
class LoadedLibrary {
public:
    /// False if the library is not installed or lacks one of the functions.
    [[nodiscard]] bool is_there() const { return handle_ != nullptr; }
    /// File name of the library.
    [[nodiscard]] const char* name() const { return name_; }

protected:
    explicit LoadedLibrary(const char* file_name);

    /// Sets `function` to that of the name; null if the library is missing.
    template <class Function>
    void find(const char* name, Function*& function) {
        function = reinterpret_cast<Function*>(address_of(name));
    }

private:
    [[nodiscard]] void* address_of(const char* name);
    struct Close {
        void operator()(void* library) const;
    };
    const char* name_;
    std::unique_ptr<void, Close> handle_;
};

}  // namespace pliant
