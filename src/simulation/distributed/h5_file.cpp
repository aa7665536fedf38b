#include "simulation/distributed/h5_file.hpp"

#include <array>
#include <utility>

namespace pliant::sim::distributed {
namespace {

/// An identifier of HDF5, closed at the end of its life.
class Id {
public:
    Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    Id(Id&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
    Id(const Id&) = delete;
    Id& operator=(const Id&) = delete;
    ~Id() {
        if (id_ >= 0) close_(id_);
    }
    operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): used as one

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

Id access(const Ranks* ranks) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are reported in one line by agree()
    Id list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    if (ranks != nullptr) H5Pset_fapl_mpio(list, ranks->comm(), MPI_INFO_NULL);
    return list;
}

Id transfer(const Ranks* ranks) {
    Id list(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
    if (ranks != nullptr) H5Pset_dxpl_mpio(list, H5FD_MPIO_COLLECTIVE);
    return list;
}

Id table_space(Rows rows, int width) {
    const std::array<hsize_t, 2> size{static_cast<hsize_t>(rows.total), static_cast<hsize_t>(width)};
    return {H5Screate_simple(width == 1 ? 1 : 2, size.data(), nullptr), H5Sclose};
}

/// This rank's rows in the file and in memory.
void select(hid_t in_file, Rows rows, int width) {
    const std::array<hsize_t, 2> start{static_cast<hsize_t>(rows.first), 0};
    const std::array<hsize_t, 2> count{static_cast<hsize_t>(rows.count), static_cast<hsize_t>(width)};
    if (rows.count > 0)
        H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    else
        H5Sselect_none(in_file);
}

Id memory_space(Rows rows, int width) {
    const std::array<hsize_t, 1> size{static_cast<hsize_t>(rows.count) * static_cast<hsize_t>(width)};
    Id space(H5Screate_simple(1, size.data(), nullptr), H5Sclose);
    if (rows.count == 0) H5Sselect_none(space);
    return space;
}

}  // namespace

H5File::H5File(const Ranks* ranks, std::filesystem::path path, hid_t file)
    : ranks_(ranks), path_(std::move(path)), file_(file) {}

H5File::H5File(H5File&& other) noexcept
    : ranks_(other.ranks_), path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}

H5File::~H5File() {
    if (file_ >= 0) H5Fclose(file_);
}

Status H5File::agree(bool good, const char* what) const {
    const Status own = good ? Status{} : failure("{}: cannot be {}", path_.string(), what);
    return ranks_ != nullptr ? ranks_->agree(own) : own;
}

Result<H5File> H5File::create(const Ranks* ranks, const std::filesystem::path& path) {
    const Id list = access(ranks);
    H5File file(ranks, path, H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, list));
    if (Status status = file.agree(file.file_ >= 0, "written"); !status) return tl::unexpected(status.error());
    return file;
}

Result<H5File> H5File::open(const Ranks& ranks, const std::filesystem::path& path) {
    const Id list = access(&ranks);
    H5File file(&ranks, path, H5Fopen(path.c_str(), H5F_ACC_RDONLY, list));
    if (Status status = file.agree(file.file_ >= 0, "read: it is not there, or damaged"); !status)
        return tl::unexpected(status.error());
    return file;
}

void H5File::write(const std::string& name, hid_t type, Rows rows, int width, const void* values) {
    const Id space = table_space(rows, width);
    const Id set(H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    select(space, rows, width);
    const Id memory = memory_space(rows, width), list = transfer(ranks_);
    written_ = set >= 0 && H5Dwrite(set, type, memory, space, list, values) >= 0 && written_;
}

void H5File::write(const std::string& name, Rows rows, int width, std::span<const double> values) {
    write(name, H5T_NATIVE_DOUBLE, rows, width, values.data());
}

void H5File::write(const std::string& name, Rows rows, int width, std::span<const int> values) {
    write(name, H5T_NATIVE_INT, rows, width, values.data());
}

Result<std::vector<double>> H5File::read(const std::string& name, Rows rows, int width) const {
    const Id set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    std::vector<double> values(static_cast<std::size_t>(rows.count) * static_cast<std::size_t>(width));
    bool good = set >= 0;
    if (good) {
        const Id space(H5Dget_space(set), H5Sclose);
        const Id wanted = table_space(rows, width);
        good = H5Sextent_equal(space, wanted) > 0;
        if (good) {
            select(space, rows, width);
            const Id memory = memory_space(rows, width), list = transfer(ranks_);
            good = H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, list, values.data()) >= 0;
        }
    }
    if (Status status = agree(good, ("read: \"" + name + "\" is not there, or of another size").c_str()); !status)
        return tl::unexpected(status.error());
    return values;
}

void H5File::write_bytes(const std::string& name, std::string bytes) {
    if (ranks_ != nullptr) ranks_->broadcast(bytes);
    const auto total = static_cast<int>(bytes.size());
    const bool writes = ranks_ == nullptr || ranks_->is_root();
    write(name, H5T_NATIVE_CHAR, {total, 0, writes ? total : 0}, 1, bytes.data());
}

Result<std::string> H5File::read_bytes(const std::string& name) const {
    const Id set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    std::string bytes;
    bool good = set >= 0;
    if (good) {
        const Id space(H5Dget_space(set), H5Sclose);
        bytes.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
        const Id list = transfer(ranks_);
        good = H5Dread(set, H5T_NATIVE_CHAR, H5S_ALL, H5S_ALL, list, bytes.data()) >= 0;
    }
    if (Status status = agree(good, ("read: \"" + name + "\" is not there").c_str()); !status)
        return tl::unexpected(status.error());
    return bytes;
}

Status H5File::close() {
    const bool closed = H5Fclose(std::exchange(file_, -1)) >= 0;
    return agree(closed && written_, "written; is the disk full?");
}

}  // namespace pliant::sim::distributed
