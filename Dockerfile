# docker build -t plcgen .
# docker run --rm -u "$(id -u):$(id -g)" -v "$PWD:/project" plcgen check .
FROM python:3.12-slim AS build
WORKDIR /src
COPY . .
RUN python -m pip wheel --quiet --no-deps --wheel-dir /wheels .

FROM python:3.12-slim
COPY --from=build /wheels /wheels
RUN python -m pip install --quiet --no-cache-dir /wheels/*.whl && rm -r /wheels
USER 65534:65534
WORKDIR /project
ENTRYPOINT ["plcgen"]
