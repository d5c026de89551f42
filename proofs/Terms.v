(* What the laws' terms guarantee: the level g, the three majorants of |v|, the two shares of plastic motion, v_d. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion.
Open Scope R_scope.

(* --- the level ----------------------------------------------------------------------------------------------------- *)

Lemma exp_neg_range x : 0 <= x -> 0 < exp (- x) <= 1.
Proof.
  intros H. split; [apply exp_pos|]. rewrite <- exp_0. destruct H as [H | <-]; [|rewrite Ropp_0; lra].
  left. apply exp_increasing. lra.
Qed.

Lemma g_newtons p v : 0 < sigma_0 p -> F_c p <= F_s p -> F_c p <= sigma_0 p * g p v <= F_s p.
Proof.
  intros H0 HF. unfold g. pose proof (exp_neg_range (v / v_s p * (v / v_s p)) (Rle_0_sqr _)) as E.
  set (e := exp _) in *.
  replace (sigma_0 p * ((F_c p + (F_s p - F_c p) * e) / sigma_0 p)) with (F_c p + (F_s p - F_c p) * e) by (field; lra).
  nra.
Qed.

Lemma g_range p v : 0 < sigma_0 p -> F_c p <= F_s p -> F_c p / sigma_0 p <= g p v <= F_s p / sigma_0 p.
Proof.
  intros H0 HF. pose proof (g_newtons p v H0 HF) as G. assert (0 < / sigma_0 p) by (apply Rinv_0_lt_compat; exact H0).
  replace (g p v) with (sigma_0 p * g p v / sigma_0 p) by (field; lra).
  split; apply Rmult_le_compat_r; lra.
Qed.

Lemma g_pos p v : 0 < sigma_0 p -> 0 < F_c p -> F_c p <= F_s p -> 0 < g p v.
Proof.
  intros H0 H1 H2. pose proof (g_range p v H0 H2). assert (0 < F_c p / sigma_0 p) by (apply Rdiv_lt_0_compat; lra). lra.
Qed.

(* --- majorants of |v| ---------------------------------------------------------------------------------------------- *)

Lemma atan_le x : 0 <= x -> atan x <= x.
Proof.
  intros Hx. assert (G : 0 - atan 0 <= x - atan x).
  { apply (grows (fun x => x - atan x) (fun x => 1 - / (1 + x ^ 2))); [exact Hx| | |].
    - intros t _. apply (is_derive_continuous _ t (1 - / (1 + t ^ 2))). auto_derive; [exact I|]. field.
      pose proof (pow2_ge_0 t). simpl in *. lra.
    - intros t _. auto_derive; [exact I|]. field. pose proof (pow2_ge_0 t). simpl in *. lra.
    - intros t _. pose proof (pow2_ge_0 t). assert (/ (1 + t ^ 2) <= / 1) by (apply Rinv_le_contravar; lra). lra. }
  rewrite atan_0 in G. lra.
Qed.

Lemma atan_nonneg x : 0 <= x -> 0 <= atan x.
Proof. intros [H | <-]; [|rewrite atan_0; lra]. rewrite <- atan_0. left. apply atan_increasing. exact H. Qed.

Lemma m_atan_even p v : m_atan p (- v) = m_atan p v.
Proof. unfold m_atan, S_0. replace (k_v p * - v) with (- (k_v p * v)) by ring. rewrite atan_opp. ring. Qed.

Theorem m_atan_majorant p v : 0 < k_v p -> Rabs v <= m_atan p v <= Rabs v + 2 / (PI * k_v p).
Proof.
  intros Hk. pose proof PI_RGT_0 as Hp.
  assert (C : 0 < 2 / (PI * k_v p)) by (apply Rdiv_lt_0_compat; nra).
  assert (E : forall u, 0 <= u -> u <= m_atan p u <= u + 2 / (PI * k_v p)).
  { intros u [Hu | <-]; unfold m_atan, S_0; [|lra].
    set (k := k_v p) in *. assert (K : 0 < k * u) by nra. assert (I : 0 < / (k * u)) by (apply Rinv_0_lt_compat; exact K).
    pose proof (atan_inv (k * u) K) as A. pose proof (atan_le (/ (k * u)) (Rlt_le _ _ I)) as L.
    pose proof (atan_nonneg (/ (k * u)) (Rlt_le _ _ I)) as P.
    replace (atan (k * u)) with (PI / 2 - atan (/ (k * u))) by lra. set (b := atan (/ (k * u))) in *.
    assert (B : b * (k * u) <= 1).
    { replace 1 with (/ (k * u) * (k * u)) by (field; split; nra). apply Rmult_le_compat_r; lra. }
    replace (u * (2 / PI * (PI / 2 - b)) + 2 / (PI * k)) with (u + 2 / (PI * k) * (1 - b * (k * u))) by (field; split; lra).
    assert (0 <= b * (k * u)) by (apply Rmult_le_pos; lra). nra. }
  unfold Rabs. destruct (Rcase_abs v) as [N | N]; [|apply E; lra]. rewrite <- m_atan_even. apply E. lra.
Qed.

(* the forms that the proofs use; the laws' are written so that no float overflows *)
Lemma m_sqrt_is p v : 0 < k_v p -> m_sqrt p v = sqrt (v * v + 1 / (k_v p * k_v p)).
Proof. intros Hk. unfold m_sqrt. f_equal. field. lra. Qed.

Lemma m_compact_is p v : 0 < k_v p -> m_compact p v =
  if Rlt_dec (k_v p * Rabs v) 1 then (3 / k_v p + 6 * k_v p * (v * v) - k_v p * (k_v p * k_v p) * (v * v * (v * v))) / 8
  else Rabs v.
Proof. intros Hk. unfold m_compact. destruct (Rlt_dec (k_v p * Rabs v) 1); [field; lra|reflexivity]. Qed.

Theorem m_sqrt_majorant p v : 0 < k_v p -> Rabs v <= m_sqrt p v <= Rabs v + 1 / k_v p.
Proof.
  intros Hk. rewrite m_sqrt_is by exact Hk. set (c := 1 / k_v p). assert (C : 0 < c) by (apply Rdiv_lt_0_compat; lra).
  replace (1 / (k_v p * k_v p)) with (c * c) by (unfold c; field; lra).
  pose proof (Rabs_pos v) as A. assert (V : Rabs v * Rabs v = v * v) by (rewrite <- Rabs_mult; apply Rabs_pos_eq; nra).
  rewrite <- V. set (x := Rabs v) in *. split.
  - rewrite <- (sqrt_square x) at 1 by exact A. apply sqrt_le_1_alt. nra.
  - rewrite <- (sqrt_square (x + c)) by lra. apply sqrt_le_1_alt. nra.
Qed.

Theorem m_compact_majorant p v : 0 < k_v p -> Rabs v <= m_compact p v <= Rabs v + 3 / (8 * k_v p).
Proof.
  intros Hk. assert (0 < 3 / (8 * k_v p)) by (apply Rdiv_lt_0_compat; lra). rewrite m_compact_is by exact Hk.
  destruct (Rlt_dec (k_v p * Rabs v) 1) as [L | L]; [|lra].
  pose proof (Rabs_pos v) as A. assert (V : v * v = Rabs v * Rabs v) by (rewrite <- Rabs_mult; symmetry; apply Rabs_pos_eq; nra).
  rewrite V. set (u := Rabs v) in *. set (k := k_v p) in *. set (x := k * u) in *.
  assert (X : 0 <= x < 1) by (split; [unfold x; nra|exact L]).
  replace ((3 / k + 6 * k * (u * u) - k * (k * k) * (u * u * (u * u))) / 8)
    with (u + ((1 - x) * ((1 - x) * (1 - x)) * (3 + x)) * / (8 * k)) by (unfold x; field; lra).
  replace (3 / (8 * k)) with (3 * / (8 * k)) by (field; lra).
  assert (I : 0 < / (8 * k)) by (apply Rinv_0_lt_compat; lra).
  assert (P : 0 <= (1 - x) * ((1 - x) * (1 - x)) * (3 + x)) by (repeat apply Rmult_le_pos; lra).
  assert (Q : (1 - x) * ((1 - x) * (1 - x)) * (3 + x) <= 3).
  { replace ((1 - x) * ((1 - x) * (1 - x)) * (3 + x)) with (3 - x * (8 - 6 * x + x * (x * x))) by ring.
    assert (0 <= x * (x * x)) by (repeat apply Rmult_le_pos; lra). assert (0 <= 8 - 6 * x + x * (x * x)) by lra. nra. }
  nra.
Qed.

(* --- shares of plastic motion --------------------------------------------------------------------------------------- *)

Definition clip01 (x : R) : R := Rmax 0 (Rmin 1 x).
Definition smoothstep (x : R) : R := clip01 x * (clip01 x * clip01 x) * (10 - 15 * clip01 x + 6 * (clip01 x * clip01 x)).
Definition sine_step (x : R) : R := 1 / 2 + 1 / 2 * sin (PI * (clip01 x - 1 / 2)).
Definition yielded p v z : R := (Rabs z - z_ba p) / (g p v - z_ba p).

Lemma clip01_range x : 0 <= clip01 x <= 1.
Proof. unfold clip01, Rmax, Rmin. destruct (Rle_dec 1 x), (Rle_dec 0 _); lra. Qed.
Lemma clip01_low x : x <= 0 -> clip01 x = 0.
Proof. intros H. unfold clip01. rewrite Rmin_right by lra. apply Rmax_left. lra. Qed.
Lemma clip01_high x : 1 <= x -> clip01 x = 1.
Proof. intros H. unfold clip01. rewrite Rmin_left by lra. apply Rmax_right. lra. Qed.
Lemma clip01_mid x : 0 <= x <= 1 -> clip01 x = x.
Proof. intros H. unfold clip01. rewrite Rmin_right by lra. apply Rmax_right. lra. Qed.
Lemma clip01_mono x y : x <= y -> clip01 x <= clip01 y.
Proof. intros H. unfold clip01. apply Rle_max_compat_l, Rle_min_compat_l, H. Qed.

Lemma smoothstep_range x : 0 <= smoothstep x <= 1.
Proof.
  unfold smoothstep. pose proof (clip01_range x) as [A B]. set (c := clip01 x) in *. split.
  - apply Rmult_le_pos; [repeat apply Rmult_le_pos; lra|nra].
  - assert (0 <= (1 - c) * ((1 - c) * (1 - c))) by (repeat apply Rmult_le_pos; lra).
    replace (c * (c * c) * (10 - 15 * c + 6 * (c * c)))
      with (1 - (1 - c) * ((1 - c) * (1 - c)) * (1 + 3 * c + 6 * (c * c))) by ring.
    assert (0 <= 1 + 3 * c + 6 * (c * c)) by nra. nra.
Qed.
Lemma smoothstep_low x : x <= 0 -> smoothstep x = 0.
Proof. intros H. unfold smoothstep. rewrite clip01_low by exact H. ring. Qed.
Lemma smoothstep_high x : 1 <= x -> smoothstep x = 1.
Proof. intros H. unfold smoothstep. rewrite clip01_high by exact H. ring. Qed.
Lemma smoothstep_mono x y : x <= y -> smoothstep x <= smoothstep y.
Proof.
  intros H. apply clip01_mono in H. unfold smoothstep. pose proof (clip01_range x). pose proof (clip01_range y).
  set (q := fun c => c * (c * c) * (10 - 15 * c + 6 * (c * c))). change (q (clip01 x) <= q (clip01 y)).
  apply (grows q (fun c => 30 * ((c * (1 - c)) * (c * (1 - c))))); [exact H| | |].
  - intros t _. apply (is_derive_continuous q t (30 * ((t * (1 - t)) * (t * (1 - t))))).
    unfold q. auto_derive; [exact I|ring].
  - intros t _. unfold q. auto_derive; [exact I|ring].
  - intros t _. pose proof (Rle_0_sqr (t * (1 - t))) as K. unfold Rsqr in K. lra.
Qed.

Lemma sine_step_range x : 0 <= sine_step x <= 1.
Proof. unfold sine_step. pose proof (SIN_bound (PI * (clip01 x - 1 / 2))). lra. Qed.
Lemma sine_step_low x : x <= 0 -> sine_step x = 0.
Proof.
  intros H. unfold sine_step. rewrite clip01_low by exact H. replace (PI * (0 - 1 / 2)) with (- (PI / 2)) by field.
  rewrite sin_neg, sin_PI2. lra.
Qed.
Lemma sine_step_high x : 1 <= x -> sine_step x = 1.
Proof.
  intros H. unfold sine_step. rewrite clip01_high by exact H. replace (PI * (1 - 1 / 2)) with (PI / 2) by field.
  rewrite sin_PI2. lra.
Qed.
Lemma sine_step_mono x y : x <= y -> sine_step x <= sine_step y.
Proof.
  intros H. apply clip01_mono in H. unfold sine_step. pose proof (clip01_range x). pose proof (clip01_range y).
  pose proof PI_RGT_0. enough (sin (PI * (clip01 x - 1 / 2)) <= sin (PI * (clip01 y - 1 / 2))) by lra.
  apply sin_incr_1; try nra.
Qed.

Lemma s_is p v z : s p v z = clip01 (yielded p v z).
Proof.
  unfold s. fold (yielded p v z). destruct (Rlt_dec (yielded p v z) 0); [symmetry; apply clip01_low; lra|].
  destruct (Rlt_dec 1 (yielded p v z)); [symmetry; apply clip01_high; lra|symmetry; apply clip01_mid; lra].
Qed.

Lemma a_is p v z : a p v z = smoothstep (yielded p v z).
Proof. unfold a. rewrite s_is. reflexivity. Qed.

Lemma alpha_0_is p v z : z_ba p < g p v -> alpha_0 p v z = sine_step (yielded p v z).
Proof.
  intros H. unfold alpha_0. assert (I : 0 < / (g p v - z_ba p)) by (apply Rinv_0_lt_compat; lra).
  destruct (Rle_dec (Rabs z) (z_ba p)) as [L | L].
  - symmetry. apply sine_step_low. unfold yielded, Rdiv. nra.
  - destruct (Rlt_dec (Rabs z) (g p v)) as [M | M].
    + unfold sine_step. rewrite clip01_mid.
      * do 2 f_equal. f_equal. unfold yielded. field. lra.
      * unfold yielded. split; [apply Rmult_le_pos; lra|].
        apply Rmult_le_reg_r with (g p v - z_ba p); [lra|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra.
    + symmetry. apply sine_step_high. unfold yielded. apply Rmult_le_reg_r with (g p v - z_ba p); [lra|].
      unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra.
Qed.

Lemma z_ba_below p v : 0 < sigma_0 p -> F_c p <= F_s p -> z_ba p * sigma_0 p < F_c p -> z_ba p < g p v.
Proof.
  intros H0 HF Hb. pose proof (g_range p v H0 HF) as G. enough (z_ba p < F_c p / sigma_0 p) by lra.
  apply Rmult_lt_reg_r with (sigma_0 p); [exact H0|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra.
Qed.

Lemma yielded_low p v z : z_ba p < g p v -> Rabs z <= z_ba p -> yielded p v z <= 0.
Proof. intros H L. unfold yielded, Rdiv. assert (0 < / (g p v - z_ba p)) by (apply Rinv_0_lt_compat; lra). nra. Qed.

Lemma yielded_high p v z : z_ba p < g p v -> g p v <= Rabs z -> 1 <= yielded p v z.
Proof.
  intros H L. unfold yielded. apply Rmult_le_reg_r with (g p v - z_ba p); [lra|].
  unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra.
Qed.

(* --- damping that falls with speed ------------------------------------------------------------------------------- *)

Lemma sigma_1_at_range p v : 0 <= sigma_1 p -> 0 <= sigma_1_at p v <= sigma_1 p.
Proof. intros H. unfold sigma_1_at. pose proof (exp_neg_range (v / v_d p * (v / v_d p)) (Rle_0_sqr _)). nra. Qed.

(* x exp(-x^2) <= (2 e)^(-1/2). *)
Lemma bell x : 0 <= x -> x * exp (- (x * x)) * Rpower (2 * exp 1) (1 / 2) <= 1.
Proof.
  intros Hx. pose proof (exp_pos 1) as E1. replace (1 / 2) with (/ 2) by field. rewrite Rpower_sqrt by lra.
  set (q := sqrt (2 * exp 1)). assert (Q : q * q = 2 * exp 1) by (apply sqrt_sqrt; lra).
  assert (Q0 : 0 <= q) by apply sqrt_pos. set (b := exp (- (x * x))). assert (B : 0 < b) by apply exp_pos.
  assert (P : 0 <= x * b * q) by (repeat apply Rmult_le_pos; lra).
  enough (x * b * q * (x * b * q) <= 1) by nra.
  replace (x * b * q * (x * b * q)) with (2 * (x * x) * (b * b * exp 1)) by (rewrite <- Rmult_1_l; nra).
  replace (b * b * exp 1) with (/ exp (2 * (x * x) - 1)).
  - apply Rmult_le_reg_r with (exp (2 * (x * x) - 1)); [apply exp_pos|].
    rewrite Rmult_assoc, Rinv_l by (apply Rgt_not_eq, exp_pos). pose proof (exp_ineq1_le (2 * (x * x) - 1)). lra.
  - unfold b. rewrite <- exp_plus, <- exp_plus, <- exp_Ropp. f_equal. ring.
Qed.

Lemma sigma_1_at_damped p v m0 : 0 <= sigma_1 p -> 0 < v_d p -> 0 <= m0 ->
  sigma_1_at p v * (Rabs v + m0) <= sigma_1 p * (v_d p / Rpower (2 * exp 1) (1 / 2) + m0).
Proof.
  intros H1 Hd Hm. unfold sigma_1_at. set (x := Rabs v / v_d p).
  assert (X : 0 <= x) by (apply Rmult_le_pos; [apply Rabs_pos|apply Rlt_le, Rinv_0_lt_compat; exact Hd]).
  assert (V : v / v_d p * (v / v_d p) = x * x).
  { unfold x. assert (V : Rabs v * Rabs v = v * v) by (rewrite <- Rabs_mult; apply Rabs_pos_eq; nra).
    replace (Rabs v / v_d p * (Rabs v / v_d p)) with (Rabs v * Rabs v / (v_d p * v_d p)) by (field; lra).
    rewrite V. field. lra. }
  rewrite V. pose proof (bell x X) as B. pose proof (exp_neg_range (x * x) (Rle_0_sqr x)) as E.
  set (q := Rpower (2 * exp 1) (1 / 2)) in *. assert (Q : 0 < q) by apply exp_pos. set (b := exp (- (x * x))) in *.
  rewrite Rmult_assoc. apply Rmult_le_compat_l; [exact H1|].
  replace (Rabs v) with (x * v_d p) by (unfold x; field; lra).
  assert (x * b <= / q).
  { apply Rmult_le_reg_r with q; [exact Q|]. rewrite Rinv_l; lra. }
  unfold Rdiv. nra.
Qed.
