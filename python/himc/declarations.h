typedef struct {
    char text[512];
    ...;
} himc_error;
typedef struct {
    double x, y, z;
} himc_vec3;
typedef struct {
    double w, x, y, z;
} himc_quat;
typedef struct himc_performance himc_performance;
typedef struct himc_take himc_take;

typedef struct {
    double joint[19];
    double contact[2];
    double mallet[2];
    double push, support, placed, numerical, kinetic, potential;
    double felt[2];
    double heads, lost;
} himc_energy;

typedef struct {
    double time;
    himc_vec3 target[2];
    himc_vec3 tip[2];
    double force[2];
    himc_vec3 joint[19];
    himc_vec3 elbow[2];
    double limit[19];
    himc_vec3 target_velocity[2];
    himc_vec3 tip_velocity[2];
    himc_vec3 tip_error[2];
    double joint_error[19];
    himc_quat rotation[19];
    himc_vec3 rate[19];
    himc_vec3 acceleration[19];
    himc_vec3 torque[19];
    double power[19];
    himc_vec3 segment[20];
    himc_quat orientation[20];
    himc_vec3 center[20];
    himc_vec3 tip_force[2];
    himc_vec3 mallet_force[2];
    double impulse[2];
    himc_vec3 push[20];
    himc_vec3 push_at[20];
    double null_space[2];
    double co_contraction[19];
    himc_vec3 root_force, root_moment, root_center;
    double root_friction;
    himc_vec3 seat_force, foot_force[2];
    himc_energy energy;
} himc_motion_row;

typedef struct {
    double time;
    int hand;
    char drum[...];
    char nuance[...];
    double x, y, velocity, force, impulse, duration, planned_time, planned_x, planned_y, beat;
} himc_strike;

typedef struct {
    double seconds;
    int strokes, played, missed;
    double tip_rms, stroke_height, tip_rms_percent, peak_force;
    int unplanned_contacts;
    double longest_contact, captured_rms, captured_most, captured_rms_percent,
        captured_most_percent, captured_speed_ratio;
    double peak_rate;
    int peak_rate_joint;
    double peak_torque;
    int peak_torque_joint;
    double reserve;
    int reserve_joint;
    int hits;
    double hit_latency, longest_latency;
    long recoveries, limit_hits, events_lost;
    double sample_rate, physics_rate, task_rate;
    ...;
} himc_performance_stats;
himc_performance_stats himc_performance_measure(const himc_performance *performance);
typedef struct himc_drum himc_drum;
himc_drum *himc_performance_drum(himc_performance *performance, int index);
void himc_drum_read(const himc_drum *drum, uint64_t start, int n, double *sound,
                    double *displacement);
void himc_performance_target(himc_performance *performance, int hand, himc_vec3 tip);
typedef struct {
    bool aimed[19], turned[19];
    himc_quat rotation[19];
    himc_vec3 rate[19];
    himc_vec3 torque[19];
} himc_drive;
const char *himc_joint_name(int joint);
const char *himc_segment_name(int segment);
const char *himc_version(void);

typedef struct {
    int hand;
    int frame;
    int clear;
    int head;
    double time;
    himc_vec3 x;
    double velocity;
    double rebound;
} himc_take_strike;

typedef struct {
    himc_performance *performance;
    himc_motion_row *rows;
    size_t row_count, row_room;
    himc_strike *strikes;
    size_t strike_count;
    himc_strike *missed;
    size_t missed_count;
    char *notes;
    size_t notes_size;
    bool done, keeps_rows, failed;
    uint64_t samples, zero;
    double peak;
    ...;
} session;
session *session_new(double rate, double physics, double task, himc_error *error);
void session_free(session *s);
bool session_command(session *s, const char *text, const char *word, himc_error *error);
bool session_drum_command(session *s, const char *drum, const char *text, himc_error *error);
bool session_add_drum(session *s, const char *name, double inches, himc_error *error);
bool session_drive(session *s, const himc_drive *drive, himc_error *error);
bool session_end_recording(session *s, himc_error *error);
bool himc_take_is_capture(const char *path);
bool session_is_command(const char *word);
int session_makes_drums(const char *score, himc_error *error);
void session_take_options(session *s, const char *left, const char *right, const char *up);
void session_keep_rows(session *s, bool keep);
void session_process(session *s, size_t n, int channels, float *out);

himc_take *take_load(const char *path, const char *left, const char *right, const char *up,
                     const char *subject, himc_error *error);
void himc_take_free(himc_take *take);
double himc_take_rate(const himc_take *take);
int himc_take_frames(const himc_take *take);
int himc_take_points(const himc_take *take);
const char *himc_take_point_name(const himc_take *take, int point);
himc_vec3 *take_points(himc_take *take);
double *take_analog(himc_take *take, int *samples, int *channels, double *rate);
const char *take_analog_name(himc_take *take, int channel);
int take_event(himc_take *take, int index, double *time, const char **label);
himc_take_strike *take_strikes(himc_take *take, const char *left, const char *right, int *count,
                               himc_error *error);
void free(void *p);

typedef struct {
    int m, n;
    double frequency, ratio, t60;
} mode_row;
int modes_of(const char *score, mode_row *out, int room, himc_error *error);
