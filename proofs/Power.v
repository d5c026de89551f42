(* Bounded and passive, for every law dz/dt = v - a(z) (M/g) z with |v| <= M <= |v| + m0 and a share a in [0, 1].

   The input w may hold more than a velocity: vel w is the velocity, M w the majorant of its absolute value, N w the
   level sigma_0 g in newtons, s1 w the damping of the bristles. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Motion.
Open Scope R_scope.

(* --- the power inequality: x = sigma_0 z, y = sigma_1 v ---------------------------------------------------------- *)

(* For y > x >= 0: sigma_1 N D >= F_s (y^2 - x y + x^2) - x y (y - x) >= x^3. *)
Lemma power_core (s1 s2 Fc Fs N M m0 v x : R) :
  0 <= s1 -> 0 <= s2 -> 0 < Fc -> Fc <= N -> 0 <= v -> 0 <= x <= Fs -> 0 <= M <= v + m0 ->
  s1 * m0 <= Fs -> s1 * (Fs - Fc) <= s2 * Fc ->
  0 <= N * ((s1 + s2) * (v * v)) + M * (x * (x - s1 * v)).
Proof.
  intros H1 H2 Hc HN Hv Hx HM Hm HL.
  assert (V : 0 <= v * v) by nra.
  destruct (Rle_lt_dec (s1 * v) x) as [E | E].
  - assert (0 <= M * (x * (x - s1 * v))) by (apply Rmult_le_pos; [|apply Rmult_le_pos]; lra).
    assert (0 <= N * ((s1 + s2) * (v * v))) by (apply Rmult_le_pos; [|apply Rmult_le_pos]; lra).
    lra.
  - assert (P : 0 < s1) by nra.
    enough (0 <= s1 * (N * ((s1 + s2) * (v * v)) + M * (x * (x - s1 * v)))) by nra.
    assert (A : s1 * Fs <= N * (s1 + s2)) by nra.
    assert (B : s1 * Fs * (s1 * (v * v)) <= N * (s1 + s2) * (s1 * (v * v))) by (apply Rmult_le_compat_r; nra).
    set (y := s1 * v) in *.
    assert (C : s1 * M * (x * (y - x)) <= (y + Fs) * (x * (y - x))).
    { apply Rmult_le_compat_r; [apply Rmult_le_pos; lra|]. unfold y. nra. }
    assert (Q : 0 <= (Fs - x) * (y * y - x * y + x * x)) by (apply Rmult_le_pos; nra).
    assert (0 <= x * x * x) by (apply Rmult_le_pos; nra).
    replace (s1 * (N * ((s1 + s2) * (v * v)) + M * (x * (x - y))))
      with (N * (s1 + s2) * (s1 * (v * v)) - s1 * M * (x * (y - x))) by ring.
    replace (s1 * Fs * (s1 * (v * v))) with (Fs * (y * y)) in B by (unfold y; ring).
    nra.
Qed.

(* The same for all signs. *)
Lemma power_signed (s1 s2 Fc Fs N M m0 v x : R) :
  0 <= s1 -> 0 <= s2 -> 0 < Fc -> Fc <= N -> Rabs x <= Fs -> Rabs v <= M <= Rabs v + m0 ->
  s1 * m0 <= Fs -> s1 * (Fs - Fc) <= s2 * Fc ->
  0 <= N * ((s1 + s2) * (v * v)) + M * (x * (x - s1 * v)).
Proof.
  intros H1 H2 Hc HN Hx HM Hm HL. pose proof (Rabs_pos v) as Av. pose proof (Rabs_pos x) as Ax.
  destruct (Rle_lt_dec 0 (v * x)) as [E | E].
  - pose proof (power_core s1 s2 Fc Fs N M m0 (Rabs v) (Rabs x)) as P.
    assert (V : Rabs v * Rabs v = v * v) by (rewrite <- Rabs_mult; apply Rabs_pos_eq; nra).
    assert (X : Rabs x * Rabs x = x * x) by (rewrite <- Rabs_mult; apply Rabs_pos_eq; nra).
    assert (VX : Rabs v * Rabs x = v * x) by (rewrite <- Rabs_mult; apply Rabs_pos_eq; exact E).
    replace (x * (x - s1 * v)) with (Rabs x * (Rabs x - s1 * Rabs v)) by nra.
    rewrite <- V. apply P; lra.
  - assert (0 <= M * (x * (x - s1 * v))) by (apply Rmult_le_pos; nra).
    assert (0 <= N * ((s1 + s2) * (v * v))) by (apply Rmult_le_pos; [|apply Rmult_le_pos]; nra). lra.
Qed.

(* With little damping, s1 M <= 4 N, no bound on x is needed. *)
Lemma power_damped (s1 s2 N M v x : R) : 0 <= s1 -> 0 <= s2 -> 0 < N -> 0 <= M -> s1 * M <= 4 * N ->
  0 <= N * ((s1 + s2) * (v * v)) + M * (x * (x - s1 * v)).
Proof.
  intros H1 H2 HN HM H4. assert (V : 0 <= v * v) by nra.
  assert (A : 0 <= M * ((x - s1 * v / 2) * (x - s1 * v / 2))) by (apply Rmult_le_pos; [exact HM|apply Rle_0_sqr]).
  assert (B : 0 <= (4 * N - s1 * M) * (s1 * (v * v))) by (apply Rmult_le_pos; [|apply Rmult_le_pos]; lra).
  assert (C : 0 <= N * (s2 * (v * v))) by (apply Rmult_le_pos; [|apply Rmult_le_pos]; lra).
  replace (N * ((s1 + s2) * (v * v)) + M * (x * (x - s1 * v)))
    with (M * ((x - s1 * v / 2) * (x - s1 * v / 2)) + (4 * N - s1 * M) * (s1 * (v * v)) / 4 + N * (s2 * (v * v))) by field.
  lra.
Qed.

(* --- laws of this form --------------------------------------------------------------------------------------------- *)
Section Law.
Context {U : UniformSpace}.
Variables (s0 s2 m0 : R) (vel M N s1 : U -> R) (share : U -> R -> R) (ok : U -> Prop).
Variables (Fc Fs s1_max : R).
Hypothesis Hs0 : 0 < s0.
Hypothesis Hs2 : 0 <= s2.
Hypothesis HFc : 0 < Fc.
Hypothesis s1_range : forall w, ok w -> 0 <= s1 w <= s1_max.
Hypothesis majorant : forall w, ok w -> Rabs (vel w) <= M w <= Rabs (vel w) + m0.
Hypothesis level : forall w, ok w -> Fc <= N w <= Fs.
Hypothesis share_range : forall w z, ok w -> 0 <= share w z <= 1.
(* all motion is plastic beyond the bound, but while the bristles unwind it may be elastic *)
Hypothesis share_beyond : forall w z, ok w -> Fs / s0 <= Rabs z -> share w z = 1 \/ (vel w * z <= 0 /\ share w z = 0).

Definition rate (w : U) (z : R) : R := vel w - share w z * (M w / (N w / s0)) * z.
Definition force (w : U) (z : R) : R := s0 * z + s1 w * rate w z + s2 * vel w.
Definition power (w : U) (z : R) : R := force w z * vel w.
Definition stored (z : R) : R := s0 * (z * z) / 2.

Lemma lost w z : ok w -> power w z - s0 * z * rate w z = (1 - share w z) * ((s1 w + s2) * (vel w * vel w))
  + share w z * (/ N w * (N w * ((s1 w + s2) * (vel w * vel w)) + M w * ((s0 * z) * (s0 * z - s1 w * vel w)))).
Proof. intros H. unfold power, force, rate. pose proof (level w H). field. lra. Qed.

Lemma lost_nonneg w z : ok w ->
  0 <= N w * ((s1 w + s2) * (vel w * vel w)) + M w * ((s0 * z) * (s0 * z - s1 w * vel w)) ->
  s0 * z * rate w z <= power w z.
Proof.
  intros H K. enough (0 <= power w z - s0 * z * rate w z) by lra. rewrite lost by exact H.
  pose proof (level w H). pose proof (share_range w z H). pose proof (s1_range w H).
  assert (0 <= / N w) by (apply Rlt_le, Rinv_0_lt_compat; lra).
  assert (0 <= (s1 w + s2) * (vel w * vel w)) by (apply Rmult_le_pos; nra).
  apply Rplus_le_le_0_compat; apply Rmult_le_pos; try lra. apply Rmult_le_pos; lra.
Qed.

(* The power inequality under LuGre's condition. *)
Theorem loses : s1_max * m0 <= Fs -> s1_max * (Fs - Fc) <= s2 * Fc ->
  forall w z, ok w -> Rabs z <= Fs / s0 -> s0 * z * rate w z <= power w z.
Proof.
  intros Hm HL w z H Hz. apply lost_nonneg; [exact H|].
  pose proof (level w H) as L. pose proof (s1_range w H) as S1. pose proof (majorant w H) as MM.
  assert (X : Rabs (s0 * z) <= Fs).
  { rewrite Rabs_mult, (Rabs_pos_eq s0) by lra. apply Rmult_le_compat_l with (r := s0) in Hz; [|lra].
    replace (s0 * (Fs / s0)) with Fs in Hz by (field; lra). lra. }
  assert (0 <= m0) by lra.
  apply power_signed with (Fc := Fc) (Fs := Fs) (m0 := m0); try lra; nra.
Qed.

(* With little damping: for every z, whatever the largest level is. *)
Theorem loses_damped : (forall w, ok w -> s1 w * M w <= 4 * N w) ->
  forall w z, ok w -> s0 * z * rate w z <= power w z.
Proof.
  intros H4 w z H. apply lost_nonneg; [exact H|].
  pose proof (level w H). pose proof (s1_range w H). pose proof (majorant w H). pose proof (Rabs_pos (vel w)).
  apply power_damped; try lra. apply H4; exact H.
Qed.

Lemma inward w z : ok w -> Fs / s0 <= z -> rate w z <= 0.
Proof.
  intros H Hz. pose proof (level w H) as L. pose proof (majorant w H) as MM.
  assert (Z : 0 < Fs / s0) by (apply Rdiv_lt_0_compat; lra). unfold rate.
  destruct (share_beyond w z H) as [-> | [E ->]]; [rewrite Rabs_pos_eq; lra| |].
  - assert (1 <= z / (N w / s0)).
    { apply Rmult_le_reg_r with (N w / s0); [apply Rdiv_lt_0_compat; lra|].
      replace (z / (N w / s0) * (N w / s0)) with z by (field; lra). rewrite Rmult_1_l.
      apply Rle_trans with (Fs / s0); [|lra]. apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat|]; lra. }
    replace (1 * (M w / (N w / s0)) * z) with (M w * (z / (N w / s0))) by (field; lra).
    pose proof (Rle_abs (vel w)). pose proof (Rabs_pos (vel w)). nra.
  - assert (vel w <= 0) by nra. lra.
Qed.

Lemma inward_below w z : ok w -> z <= - (Fs / s0) -> 0 <= rate w z.
Proof.
  intros H Hz. pose proof (level w H) as L. pose proof (majorant w H) as MM.
  assert (Z : 0 < Fs / s0) by (apply Rdiv_lt_0_compat; lra). unfold rate.
  destruct (share_beyond w z H) as [-> | [E ->]]; [rewrite Rabs_left; lra| |].
  - assert (1 <= - z / (N w / s0)).
    { apply Rmult_le_reg_r with (N w / s0); [apply Rdiv_lt_0_compat; lra|].
      replace (- z / (N w / s0) * (N w / s0)) with (- z) by (field; lra). rewrite Rmult_1_l.
      apply Rle_trans with (Fs / s0); [|lra]. apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat|]; lra. }
    replace (vel w - 1 * (M w / (N w / s0)) * z) with (vel w + M w * (- z / (N w / s0))) by (field; lra).
    pose proof (Rcomplements.Rabs_maj2 (vel w)). pose proof (Rabs_pos (vel w)). nra.
  - assert (0 <= vel w) by nra. lra.
Qed.

(* |z| <= F_s/sigma_0 is kept, whatever the input. *)
Theorem bounded u z t1 t2 : motion rate u z t1 t2 -> (forall t, t1 <= t <= t2 -> ok (u t)) ->
  Rabs (z t1) <= Fs / s0 -> forall t, t1 <= t <= t2 -> Rabs (z t) <= Fs / s0.
Proof.
  intros Mo Hok H0. apply (motion_within rate ok (Fs / s0) u z t1 t2 Mo Hok H0); intros w x Hw Hx.
  - apply inward; auto.
  - apply inward_below; auto.
Qed.

Lemma is_derive_stored x : is_derive stored x (s0 * x).
Proof. unfold stored. auto_derive; [exact I|field]. Qed.

Lemma stored_nonneg x : 0 <= stored x.
Proof. unfold stored. assert (0 <= x * x) by nra. nra. Qed.

Hypothesis power_continuous : continuous_2 power.

(* The bristles' elastic energy is a storage function under LuGre's condition. *)
Theorem stores : s1_max * m0 <= Fs -> s1_max * (Fs - Fc) <= s2 * Fc ->
  storage rate ok power (fun z => Rabs z <= Fs / s0) stored.
Proof.
  intros Hm HL. apply storage_by with (fun x => s0 * x); auto.
  - intros u z a b Mo Hok Hz. apply (bounded u z a b); auto.
  - apply is_derive_stored.
  - intros; apply stored_nonneg.
  - intros w x Hw Hx. apply loses; auto.
Qed.

Theorem stores_damped : (forall w, ok w -> s1 w * M w <= 4 * N w) -> storage rate ok power any stored.
Proof.
  intros H4. apply storage_by with (fun x => s0 * x); [|exact power_continuous| | |].
  - intros u z a b _ _ _ t _. exact I.
  - apply is_derive_stored.
  - intros; apply stored_nonneg.
  - intros w x Hw _. apply loses_damped; auto.
Qed.
End Law.
