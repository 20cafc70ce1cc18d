/* The application that the files belong to. */
#define EXAMPL_DEV_CONFIG_VERSION 44
