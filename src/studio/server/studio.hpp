// The studio without its network server: its contents, and its answers to requests. `server.hpp` connects it to a
// socket.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "studio/base/http.hpp"
#include "studio/files/thumbnails.hpp"
#include "studio/make/make_session.hpp"
#include "studio/print/print_queue.hpp"
#include "studio/print/print_session.hpp"
#include "studio/print/projector_session.hpp"
#include "studio/requests/message.hpp"
#include "studio/requests/project_folder.hpp"
#include "studio/search/search_session.hpp"
#include "studio/server/hub.hpp"
#include "studio/server/routes.hpp"
#include "studio/simulate/simulation_session.hpp"

namespace pliant::studio {

struct Start {
    std::filesystem::path file;  ///< robot file or job; empty: the built-in example
    std::string version;
    std::string notify{};  ///< command that is run when a print ends or waits for a person; "": none
    std::string webcam{};  ///< address of a camera image of the machine, http or https; "": none
};

class Studio {
public:
    /// Errors: the file cannot be read, or is neither a robot file nor a job. A robot file with errors is opened: the
    /// page shows them.
    [[nodiscard]] static Result<std::unique_ptr<Studio>> open(const Start& start);
    ~Studio();
    Studio(const Studio&) = delete;
    Studio& operator=(const Studio&) = delete;

    /// Answers a request that has passed access control. Thread-safe.
    [[nodiscard]] Response handle(const Request& request);
    /// True if the route reads the body itself, by Request::more.
    [[nodiscard]] bool streams(const Request& request) const;
    [[nodiscard]] std::shared_ptr<Connection> join() { return hub_.join(); }
    void leave(const std::shared_ptr<Connection>& connection) { hub_.leave(connection); }
    /// Processes a message of a page. Invalid or forbidden ones are answered with {"type": "error"}.
    void receive(const std::shared_ptr<Connection>& connection, std::string_view text);
    /// Closes all connections.
    void close() { hub_.close_all(); }

    [[nodiscard]] Hub& hub() { return hub_; }
    [[nodiscard]] ProjectFolder& folder() { return folder_; }
    [[nodiscard]] SimulationSession& simulation() { return *simulation_; }
    [[nodiscard]] SearchSession& search() { return *search_; }
    [[nodiscard]] Thumbnails& thumbnails() { return thumbnails_; }
    /// PNG of the robot as drawn, which a page shows until its 3D view is ready. Null: there is none.
    [[nodiscard]] std::shared_ptr<const std::string> first_picture(bool dark, const std::stop_token& stop = {});
    [[nodiscard]] MakeSession& make() { return *make_; }
    [[nodiscard]] PrintSession& print() { return *print_; }
    [[nodiscard]] PrintQueue& queue() { return *queue_; }
    [[nodiscard]] ProjectorSession& projector() { return *projector_; }
    [[nodiscard]] const std::string& version() const { return start_.version; }
    [[nodiscard]] const std::string& webcam() const { return start_.webcam; }
    [[nodiscard]] const std::vector<Route>& routes() const { return routes_; }

    /// The robot file being edited: as opened, its current text, and earlier ones.
    struct Document {
        std::string name;  ///< relative to the folder; empty: never saved
        std::filesystem::path file;
        std::string text, saved;
        std::vector<std::string> undo, redo;
        Accuracy accuracy = Accuracy::automatic;
        std::vector<std::string> outside{};  ///< paths outside the folder in the file with which the studio was started
        std::string title = "new";           ///< what pages call it while it has no name
        std::int64_t opened = 0;             ///< number of this document
        std::string stamps{};                ///< ProjectFolder::stamps_of() it when it was built last
        bool windows_lines = false;          ///< lines of its file end with CR LF; here they always end with LF

        /// SHA-256 of the text, and of the stamps if it names files.
        [[nodiscard]] std::string digest() const;
    };
    [[nodiscard]] Document document();
    /// Checks and builds the new text.
    [[nodiscard]] Status edit(const std::string& text);
    /// The same with what `change` makes of the present text, which nobody else changes meanwhile.
    [[nodiscard]] Status edit_by(const std::function<Result<std::string>(const std::string& text)>& change);
    /// Builds the robot again if a file that it names is not the one that it was built from.
    void look_at_files();
    /// The errors of a text, without building it.
    [[nodiscard]] Status check(const std::string& text);
    [[nodiscard]] Status undo();
    [[nodiscard]] Status redo();
    enum class Saved { done, changed_elsewhere };
    /// Under another name, or "": that of its file, unless that holds anything else than what was opened or saved last
    /// (changed_elsewhere: nothing is written) and `overwrite` is false. Errors: another file has that name, the name
    /// does not end with .toml, it cannot be written, the robot names files that lie outside as seen from there.
    [[nodiscard]] Result<Saved> save(const std::string& name, bool overwrite = false);
    [[nodiscard]] Status open_file(const std::string& name);
    void open_example(const std::string& name);
    /// Opens a robot that has no file yet; `name`: of the file that its text came from, "" if none. Errors: as for
    /// edit(); `name` is not that of a robot file.
    [[nodiscard]] Status open_new(const std::string& text, const std::string& name = {});
    void set_accuracy(Accuracy accuracy);

    /// Adds a second robot for comparison: it receives every input of the first one, and has a scene and frames of its
    /// own. `name`: a robot file of the folder; or an example; both empty: the current robot, which then stays
    /// unchanged while the first one is edited. Errors: as for open_file(); there is no such example.
    [[nodiscard]] Status compare(const std::string& name, const std::string& example);
    void stop_comparing();
    /// Null if there is none.
    [[nodiscard]] std::shared_ptr<SimulationSession> beside();

private:
    Studio(ProjectFolder folder, Start start);
    [[nodiscard]] Status start(const std::filesystem::path& file);
    [[nodiscard]] Status check_text(const std::string& text) const;
    [[nodiscard]] Status replace(const std::string& text);
    /// Undo or redo: restores the last text of `from`; the current one is appended to `to`.
    void take_back(std::vector<std::string>& from, std::vector<std::string>& to);
    void rebuild(After after);
    [[nodiscard]] SessionEvents events_beside();
    /// Applies a page's message to one of the robots.
    void steer(const Message& message, SimulationSession& simulation, bool beside);
    void greet(const std::shared_ptr<Connection>& connection);

    ProjectFolder folder_;
    Start start_;
    Hub hub_;
    std::unique_ptr<SimulationSession> simulation_;
    std::unique_ptr<SearchSession> search_;
    std::unique_ptr<MakeSession> make_;
    std::unique_ptr<PrintSession> print_;
    std::unique_ptr<PrintQueue> queue_;
    std::unique_ptr<ProjectorSession> projector_;
    Thumbnails thumbnails_;
    std::vector<Route> routes_;
    /// Robots and jobs are numbered from here, which no other studio does: a page that stays open while the studio is
    /// started again, perhaps with another file, tells by the numbers that what it knows is of the one before.
    const std::int64_t numbers_from_;
    std::mutex mutex_;  ///< guards what follows
    Document document_;
    std::int64_t opened_ = numbers_from_;  ///< see Document::opened
    RobotText text_beside_;
    std::vector<std::string> outside_beside_;    ///< see Document::outside
    std::string title_beside_;                   ///< file that the second robot was opened from
    std::shared_ptr<SimulationSession> beside_;  ///< null: no second robot
};

}  // namespace pliant::studio
