/* Kinds of application relations. */
enum { PNIO_AR_TYPE_SINGLE = 1, PNIO_AR_TYPE_SUPERVISOR = 6, PNIO_AR_TYPE_SINGLE_RTC3 = 16 };
